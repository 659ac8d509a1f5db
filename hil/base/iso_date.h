#pragma once
// Days as the files of a bench and of waivers write them.

#include <string>

namespace forcegate {

/// Of the Gregorian calendar; `month` from 1.
int days_of_month(int year, int month);

/// "2026-12-31"; "2026-02-30" is none.
bool is_iso_date(const std::string& text);

}  // namespace forcegate
