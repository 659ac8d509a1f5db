#pragma once
// Forces and voltages that no bench has: of them nothing can be told, and nothing would be missed.

#include <filesystem>
#include <map>
#include <string>

#include "hil/base/result.h"
#include "hil/trace/trace.h"

namespace forcegate {

/// `headers`: of channels by name, as the file writes them; may be empty. Error (parse): more than a thousandth of F_ref or U lies beyond
/// 1e12 N or V; with the column and what to do.
Result<void> check_plausible_sizes(const Trace& trace, const std::map<std::string, std::string>& headers, const std::filesystem::path& file);

}  // namespace forcegate
