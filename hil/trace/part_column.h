#pragma once
// A column that tells which sensor, trial or specimen a row belongs to, as tidy tables have it: rows of several recordings in one file.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/csv_table.h"

namespace forcegate {

inline constexpr std::size_t kMostParts = kMostWords;

struct PartColumn {
  std::string header;
  std::vector<std::string> parts;          ///< as the cells say it, in the order in which they come; at most kMostParts
  std::vector<std::uint8_t> part_of_row;   ///< index into `parts`
  std::size_t changes = 0;                 ///< rows of another part than the row before
};

/// The column called `header`, of whole numbers or words. Errors (usage): no such column, cells that are missing or neither, more than
/// kMostParts different ones, a single one.
Result<PartColumn> part_column(const CsvTable& table, std::string_view header, const std::string& where);

/// The rows of one part, without that column; lines keep their numbers.
CsvTable rows_of_part(const CsvTable& table, const PartColumn& column, std::size_t part);

/// Refuses a table where sensors take turns, row by row: a column whose name says that it tells sensors apart, with another value in a quarter of the
/// rows and more, or words that are others in nearly every row. Read as one recording it is a hum and a loop of nobody. `is_given`: whether --map gives a column a meaning.
Result<void> check_one_sensor(const CsvTable& table, const std::function<bool(const std::string& header)>& is_given, const std::string& where);

/// Header of a column that has one value up to `row` and another one from it on, as of trials that stand one below the other; "" for none.
std::string column_that_changes_at(const CsvTable& table, std::size_t row);

/// "forcegate convert FILE FOLDER --split COLUMN"
std::string split_command(const std::string& file, std::string_view header);

}  // namespace forcegate
