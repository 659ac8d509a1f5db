#pragma once
// Days as the files of a bench and of waivers write them.

#include <string>

namespace forcegate {

/// "2026-12-31"; "2026-02-30" is none.
bool is_iso_date(const std::string& text);

}  // namespace forcegate
