#include "hil/trace/date_column.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/base/text.h"
#include "hil/trace/csv_hints.h"
#include "hil/trace/time_base.h"

namespace forcegate {
namespace {

constexpr double kDay_s = 86400.0;

bool is_time_of_day(const CsvColumn& column) {
  return column.dates && std::ranges::all_of(column.value, [](double t) { return !std::isfinite(t) || (t >= 0.0 && t <= kDay_s); });
}

bool is_called_date(const TextColumn& column) {
  constexpr std::array kNames = {"date", "datum", "day", "tag"};
  const std::string word = ascii_lower(trim(column.header));
  return std::ranges::find(kNames, word) != kNames.end();
}

std::vector<double> with_gaps_filled(std::vector<double> day_s) {
  for (std::size_t i = 1; i < day_s.size(); ++i)
    if (!std::isfinite(day_s[i])) day_s[i] = day_s[i - 1];
  return day_s;
}

// A meter that is over its range writes a word where others have a number, from the first row on if nothing loads the sensor.
bool is_over_range(const TextColumn& column) {
  constexpr std::array kWords = {"ol", "o.l", "0l", "0.l", "ovld", "over", "overload", "overflow", "ovrng", "ovr"};
  const std::string word = ascii_lower(column.cell);
  return std::ranges::any_of(kWords, [&](std::string_view over) { return word == over || word == "-" + std::string(over) || word == "+" + std::string(over); });
}

std::string left_out_text(const TextColumn& column) {
  const std::string note = "column \"" + column.header + "\" holds text and was left out";
  return is_over_range(column) ? note + ": \"" + column.cell + "\" in line " + std::to_string(column.line) + " is a meter over its range" : note;
}

}  // namespace

void add_dates(std::vector<TextColumn>& text_columns, CsvColumn* clock, const std::vector<std::string>& unused, std::vector<std::string>& notes) {
  std::vector<const TextColumn*> dates;
  for (const TextColumn& column : text_columns)
    if (!column.day_s.empty() && std::ranges::find(unused, column.header) == unused.end()) dates.push_back(&column);
  if (dates.size() > 1) std::erase_if(dates, [](const TextColumn* column) { return !is_called_date(*column); });
  std::string taken;
  if (dates.size() == 1 && clock != nullptr && is_time_of_day(*clock) && dates.front()->day_s.size() == clock->value.size()) {
    const std::vector<double> day_s = with_gaps_filled(dates.front()->day_s);
    const bool one_day = std::ranges::all_of(day_s, [&](double day) { return day == day_s.front(); });
    if (const std::size_t days = one_day ? count_midnights(clock->value) : 0; days > 0) notes.push_back(note_of_midnights(days));
    for (std::size_t i = 0; i < day_s.size(); ++i) clock->value[i] += day_s[i];
    taken = dates.front()->header;
    notes.push_back("columns \"" + taken + "\" and \"" + clock->header + "\" are the clock together: date and time of day");
  }
  if (taken.empty() && clock != nullptr && is_time_of_day(*clock))
    for (const TextColumn& column : text_columns)
      if (column.hint.starts_with(kWhichIsTheMonth)) notes.push_back("column \"" + column.header + "\" is no part of the clock: " + column.hint);
  std::erase_if(text_columns, [&](const TextColumn& column) {
    if (column.header == taken || std::ranges::find(unused, column.header) != unused.end()) return true;
    notes.push_back(left_out_text(column));
    return false;
  });
}

}  // namespace forcegate
