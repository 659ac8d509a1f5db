#pragma once
// `forcegate convert --split`: a table of several sensors or trials into one file for each.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct SplitRequest {
  std::filesystem::path from, folder;
  std::string column;  ///< header of the column that tells the parts
  std::map<std::string, std::string> column_map;
  double assumed_rate_Hz = 0.0;  ///< 0: a file without a clock is refused
  bool overwrite = false;
};

struct SplitPart {
  std::string part;  ///< as the column says it
  std::filesystem::path file;
  std::size_t rows = 0;
  double duration_s = 0.0;
};

struct SplitReport {
  std::vector<SplitPart> parts;
  std::vector<std::string> notes;  ///< what was assumed, converted or dropped; those of one part begin with its name
  bool take_turns = false;  ///< sensors beside each other in time; else trials one after the other
};

/// NAME-PART.csv for each value of the column, in order of their first rows; nothing is written where one of them cannot be read. Errors: those of
/// read_csv and part_column; usage: an output that exists (without `overwrite`), a file that is no text.
Result<SplitReport> split(const SplitRequest& request);

}  // namespace forcegate
