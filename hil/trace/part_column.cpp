#include "hil/trace/part_column.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::size_t kFewestRows = 32;

struct Parts {
  std::vector<std::string> parts;
  std::vector<std::uint8_t> part_of_row;
  std::size_t changes = 0;
};

std::size_t changes_of(const std::vector<std::uint8_t>& part_of_row) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < part_of_row.size(); ++i) n += part_of_row[i] != part_of_row[i - 1];
  return n;
}

// nullopt: a missing cell, one that is no whole number, or too many values
std::optional<Parts> parts_of(const std::vector<double>& values) {
  Parts out;
  std::vector<double> seen;
  out.part_of_row.reserve(values.size());
  for (const double v : values) {
    if (!(v == std::floor(v))) return std::nullopt;
    const auto at = std::ranges::find(seen, v);
    if (at == seen.end() && seen.size() == kMostParts) return std::nullopt;
    out.part_of_row.push_back(static_cast<std::uint8_t>(at - seen.begin()));
    if (at == seen.end()) seen.push_back(v);
  }
  for (const double v : seen) out.parts.push_back(plain_number(v));
  out.changes = changes_of(out.part_of_row);
  return out;
}

std::optional<Parts> parts_of(const TextColumn& column) {
  if (column.words.empty() || std::ranges::find(column.words, "") != column.words.end()) return std::nullopt;
  return Parts{column.words, column.word_of_row, changes_of(column.word_of_row)};
}

// "ch", "Sensor ID", "node_id", "deviceId"
bool tells_sensors_apart(std::string_view header) {
  constexpr std::array<std::string_view, 19> kWords{"ch", "chan", "channel", "sensor", "sensors", "sensorid", "channelid", "deviceid", "nodeid", "id",
                                                    "node", "device", "dev", "addr", "address", "pin", "mux", "probe", "unit"};
  const std::string lower = ascii_lower(header);
  std::string word;
  for (std::size_t i = 0; i <= lower.size(); ++i) {
    const char c = i < lower.size() ? lower[i] : ' ';
    if (c >= 'a' && c <= 'z') {
      word += c;
      continue;
    }
    if (std::ranges::find(kWords, word) != kWords.end()) return true;
    word.clear();
  }
  return false;
}

std::string first_of(const Parts& parts) {
  std::string shown;
  constexpr std::size_t kShown = 4;
  for (std::size_t i = 0; i < std::min(kShown, parts.part_of_row.size()); ++i) shown += parts.parts[parts.part_of_row[i]] + ", ";
  return shown + "...";
}

}  // namespace

Result<PartColumn> part_column(const CsvTable& table, std::string_view header, const std::string& where) {
  std::optional<Parts> parts;
  std::vector<std::string> headers;
  bool found = false;
  for (const CsvColumn& column : table.columns) {
    headers.push_back(column.header);
    if (column.header != header) continue;
    found = true;
    parts = parts_of(column.value);
  }
  for (const TextColumn& column : table.text_columns) {
    headers.push_back(column.header);
    if (column.header != header) continue;
    found = true;
    parts = parts_of(column);
  }
  if (!found) return fail(ErrorCode::usage, "there is no column \"" + std::string(header) + "\"", where, "the columns are " + join(headers, ", "));
  if (!parts)
    return fail(ErrorCode::usage,
                "column \"" + std::string(header) +
                    "\" does not tell parts of the file: a cell of it is empty or a broken number, or it has more than " +
                    std::to_string(kMostParts) + " values",
                where, "name a column of whole numbers or words, such as a sensor's or a trial's");
  if (parts->parts.size() < 2)
    return fail(ErrorCode::usage,
                "column \"" + std::string(header) + "\" is " + parts->parts.front() + " in every row: there is nothing to split", where,
                "leave --split out");
  return PartColumn{std::string(header), std::move(parts->parts), std::move(parts->part_of_row), parts->changes};
}

CsvTable rows_of_part(const CsvTable& table, const PartColumn& column, std::size_t part) {
  CsvTable out;
  out.notes = table.notes;
  out.above = table.above;
  out.header_line = table.header_line;
  const auto keep = [&](const auto& values) {
    std::remove_cvref_t<decltype(values)> kept;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (column.part_of_row[i] == part) kept.push_back(values[i]);
    return kept;
  };
  for (const CsvColumn& from : table.columns) {
    if (from.header == column.header) continue;
    CsvColumn to{from.header, keep(from.value), from.dates, 0};
    to.missing = static_cast<std::size_t>(std::ranges::count_if(to.value, [](double v) { return std::isnan(v); }));
    out.columns.push_back(std::move(to));
  }
  for (const TextColumn& from : table.text_columns) {
    if (from.header == column.header) continue;
    TextColumn to = from;
    to.day_s = keep(from.day_s);
    to.word_of_row = keep(from.word_of_row);
    out.text_columns.push_back(std::move(to));
  }
  out.skipped_lines = table.skipped_lines;
  if (table.header_line > 0)
    for (std::size_t i = 0; i < column.part_of_row.size(); ++i)
      if (column.part_of_row[i] != part) out.skipped_lines.push_back(table.line_of_row(i));
  std::ranges::sort(out.skipped_lines);
  return out;
}

Result<void> check_one_sensor(const CsvTable& table, const std::function<bool(const std::string&)>& is_given, const std::string& where) {
  const std::size_t rows = table.rows();
  constexpr std::size_t kMostSensors = 16;
  if (rows < kFewestRows) return {};
  const auto refuse = [&](const std::string& header, const std::optional<Parts>& parts, bool is_named) -> Result<void> {
    if (!parts || parts->parts.size() < 2 || parts->parts.size() > kMostSensors) return {};
    const double changes = static_cast<double>(parts->changes) / static_cast<double>(rows - 1);
    constexpr double kTakesTurns = 0.25, kEveryRow = 0.95;
    if (changes < (is_named ? kTakesTurns : kEveryRow)) return {};
    return fail(ErrorCode::parse, "rows of several sensors stand in one file: column \"" + header + "\" is " + first_of(*parts) + " in turn", where,
                "make one file for each: " + split_command(where, header) + "; where it tells no sensors apart, --map " + shell_quoted(header + "=unused"));
  };
  for (const CsvColumn& column : table.columns)
    if (!is_given(column.header) && tells_sensors_apart(column.header)) FORCEGATE_CHECK_OK(refuse(column.header, parts_of(column.value), true));
  for (const TextColumn& column : table.text_columns)
    if (!is_given(column.header)) FORCEGATE_CHECK_OK(refuse(column.header, parts_of(column), tells_sensors_apart(column.header)));
  return {};
}

std::string column_that_changes_at(const CsvTable& table, std::size_t row) {
  const auto changes = [&](const std::optional<Parts>& parts) {
    if (!parts || row == 0 || row >= parts->part_of_row.size()) return false;
    const auto begin = parts->part_of_row.begin(), at = begin + static_cast<std::ptrdiff_t>(row);
    return parts->part_of_row[row] != parts->part_of_row.front() && std::adjacent_find(begin, at, std::not_equal_to<>()) == at;
  };
  for (const CsvColumn& column : table.columns)
    if (changes(parts_of(column.value))) return column.header;
  for (const TextColumn& column : table.text_columns)
    if (changes(parts_of(column))) return column.header;
  return {};
}

std::string split_command(const std::string& file, std::string_view header) {
  return "forcegate convert " + shell_quoted(file) + " FOLDER --split " + shell_quoted(header);
}

}  // namespace forcegate
