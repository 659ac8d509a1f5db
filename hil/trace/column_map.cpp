#include "hil/trace/column_map.h"

#include <algorithm>

#include "hil/base/text.h"
#include "hil/trace/columns.h"
#include "hil/trace/convert.h"

namespace forcegate {

Result<ColumnMap> parse_column_map(std::span<const std::string> words) {
  ColumnMap out;
  for (const std::string& word : words) {
    const std::size_t equals = word.rfind('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == word.size())
      return fail(ErrorCode::usage, "\"" + printable_utf8(word) + "\" is not COLUMN=NAME", "--map", "write for example --map \"Load cell=F_ref_N\"");
    out[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return out;
}

Result<void> check_column_map(const ColumnMap& map, std::span<const std::string> mapped, std::span<const Trace* const> traces,
                              const std::filesystem::path& where) {
  for (const auto& [from, to] : map) {
    if (std::ranges::find(mapped, from) != mapped.end()) continue;
    std::vector<std::string> columns;
    for (const Trace* trace : traces)
      for (const Channel& c : trace->channels)
        if (const std::string name = header_of(c.name, c.unit); std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
    return fail(ErrorCode::usage, "no record has a column \"" + from + "\" to map to " + to, where.string(),
                "there are " + join(columns, ", ") + "; only columns of CSV and MAT files can be mapped");
  }
  return {};
}

Result<TraceFile> read_mapped_trace(const std::filesystem::path& path, std::string_view map, double assumed_rate_Hz) {
  std::vector<std::string> words;
  if (!map.empty()) words = split(map, '\n');
  FORCEGATE_TRY(const ColumnMap columns, parse_column_map(words));
  FORCEGATE_TRY(TraceFile file, read_trace(path, {columns, assumed_rate_Hz}));
  const Trace* const only[] = {&file.trace};
  FORCEGATE_CHECK_OK(check_column_map(columns, file.mapped, only, path));
  return file;
}

std::string column_map_advice(const Trace& trace, std::string_view name, std::string_view unit) {
  static constexpr const char* kTaken[] = {"F_ref", "F_cmd", "F_dut", "U", "drive", "supply"};
  const std::string wanted(name);
  for (const Channel& c : trace.channels)
    if (c.unit == unit && std::ranges::find(kTaken, c.name) == std::ranges::end(kTaken))
      return "--map " + shell_quoted(header_of(c.name, c.unit) + "=" + wanted + "_" + c.unit);
  for (const Channel& c : trace.channels)  // a column that is called by its unit
    if (const auto called = find_unit(c.name); c.unit.empty() && called && called->canonical == unit)
      return "--map " + shell_quoted(c.name + "=" + wanted + "_" + c.name);
  return "--map NAME=" + wanted + "_" + std::string(unit);
}

}  // namespace forcegate
