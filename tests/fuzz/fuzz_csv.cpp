// Any bytes as a CSV file: never a crash, and what is accepted holds together.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "hil/trace/csv.h"
#include "hil/trace/part_column.h"

// The rows of all parts are the rows of the table, each in the line where it stood.
static void split_by_every_column(std::string_view bytes) {
  const auto table = forcegate::parse_csv_table(bytes, "fuzz.csv");
  if (!table) return;
  const auto split = [&](const std::string& header) {
    const auto column = forcegate::part_column(*table, header, "fuzz.csv");
    if (!column) return;
    std::size_t rows = 0;
    for (std::size_t p = 0; p < column->parts.size(); ++p) {
      const forcegate::CsvTable part = forcegate::rows_of_part(*table, *column, p);
      std::size_t at = 0;
      for (std::size_t i = 0; i < column->part_of_row.size(); ++i)
        if (column->part_of_row[i] == p && part.line_of_row(at++) != table->line_of_row(i)) std::abort();
      rows += at;
    }
    if (rows != table->rows()) std::abort();
  };
  for (const auto& c : table->columns) split(c.header);
  for (const auto& c : table->text_columns) split(c.header);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  split_by_every_column(bytes);
  const auto file = forcegate::parse_csv(bytes, "fuzz.csv",
                                         {.column_map = {}, .assumed_rate_Hz = size % 2 == 0 ? 100.0 : 0.0});
  if (!file) {
    if (file.error().text.empty()) std::abort();
    return 0;
  }
  const auto& t = file->trace.time_bases.at(0).t_s;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (!(t[i] > t[i - 1])) std::abort();
  for (const auto& channel : file->trace.channels)
    if (channel.value.size() != t.size() || (!channel.raw.empty() && channel.raw.size() != t.size()))
      std::abort();
  return 0;
}
