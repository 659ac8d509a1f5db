#include "hil/trace/no_clock.h"

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "hil/trace/clock_unit.h"
#include "hil/trace/csv_hints.h"

namespace forcegate {
namespace {

constexpr std::size_t kMostNames = 8;

std::string some_of(std::vector<std::string> names) {
  if (names.size() > kMostNames) names.resize(kMostNames), names.push_back("...");
  return join(names, ", ");
}

// 0, 1, 2: of samples as well as of seconds.
bool counts_rows(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] != values[i - 1] + 1.0) return false;
  return values.size() > 2 && values.front() == std::floor(values.front());
}

// "--map T_S=t_s --map u_v=U_V" of columns that are a clock and others but for their capitals; empty where none is a clock.
std::string maps_of_capitals(const std::vector<std::string>& headers) {
  std::string maps;
  bool clock = false;
  for (const std::string& header : headers) {
    const std::string meant = meant_but_for_capitals(header);
    if (meant.empty()) continue;
    clock = clock || meant.starts_with("t_");
    maps += (maps.empty() ? "--map " : " --map ") + shell_quoted(header + "=" + meant);
  }
  return clock ? maps : "";
}

bool is_dated(const TextColumn& column) { return column.hint.starts_with(kWhichIsTheMonth); }

}  // namespace

Unexpected no_clock(const CsvTable& table, const std::vector<ColumnMeaning>& meanings, const std::string& where) {
  std::vector<std::string> headers, texts;
  const CsvColumn* likely = nullptr;  // not a column that is something else
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    headers.push_back(table.columns[c].header);
    if (likely == nullptr && meanings[c].unit.symbol.empty()) likely = &table.columns[c];
  }
  for (const TextColumn& column : table.text_columns) texts.push_back(column.header + " (\"" + column.cell + "\")");
  const std::string text = "there is no time column among: " + some_of(headers) + (texts.empty() ? "" : "; left out, since they hold text: " + some_of(texts));
  const std::string at = table.header_line > 0 ? where + ":" + std::to_string(table.header_line) : where;
  std::string hint;
  if (const auto dated = std::ranges::find_if(table.text_columns, is_dated); dated != table.text_columns.end()) {
    hint = dated->hint;
  } else if (const std::string maps = maps_of_capitals(headers); !maps.empty()) {
    return fail(ErrorCode::parse, text, at, "units are told apart by their capitals: " + maps);
  } else if (likely == nullptr) {
    hint = "give --rate HZ, or \"fs_Hz\" in campaign.json, for a file without one";
  } else if (counts_rows(likely->value)) {
    hint = "\"" + likely->header + "\" counts the rows: give their rate, --rate HZ; where it counts seconds, --map " + shell_quoted(likely->header + "=t_s");
  } else {
    const std::string unknown = unknown_unit(likely->header);
    const std::optional<Unit> called = find_unit(likely->header);  // a column that is called by its unit
    const std::string unit = called && called->quantity == "time" ? called->symbol : may_count_days(likely->value) ? "days" : "s";
    hint = "say which is the clock, for instance --map " + shell_quoted(likely->header + "=t_" + unit) +
           (unknown.empty() ? "" : " where \"" + unknown + "\" means seconds, t_ms and t_us for milli- and microseconds") + ", or give --rate HZ for a file without one";
  }
  if (std::ranges::none_of(meanings, [](const ColumnMeaning& m) { return known_name(m.name) == "F_ref" || m.unit.quantity == "force"; }))
    hint += "; none of them is the reference force either: where there is one, --map NAME=F_ref_N, and of an output alone forcegate diagnose tells the drift";
  if (!texts.empty() && likely != nullptr && table.text_columns.size() >= table.columns.size())
    hint = "if line " + std::to_string(table.text_columns.front().line) + " is no row, take it out; then " + hint;
  return fail(ErrorCode::parse, text, at, hint);
}

}  // namespace forcegate
