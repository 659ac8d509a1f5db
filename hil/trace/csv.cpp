#include "hil/trace/csv.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <optional>

#include "hil/base/output_path.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/trace/clock_unit.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"
#include "hil/trace/csv_hints.h"
#include "hil/trace/date_column.h"
#include "hil/trace/missing_count.h"
#include "hil/trace/no_clock.h"
#include "hil/trace/part_column.h"
#include "hil/trace/sensor_name.h"
#include "hil/trace/time_base.h"

namespace forcegate {
namespace {

void keep_rows(std::vector<double>& column, const std::vector<std::size_t>& rows) {
  std::vector<double> kept;
  kept.reserve(rows.size());
  for (const std::size_t r : rows) kept.push_back(column[r]);
  column = std::move(kept);
}

/// Empty unless every value is a whole number or missing.
std::vector<std::int32_t> counts_of(const std::vector<double>& values) {
  std::vector<std::int32_t> raw;
  raw.reserve(values.size());
  for (const double v : values) {
    if (std::isnan(v))
      raw.push_back(kMissingCount);
    else if (v == std::floor(v) && std::fabs(v) < 2147483647.0)
      raw.push_back(static_cast<std::int32_t>(v));
    else
      return {};
  }
  return raw;
}

// `headers`: of the channels.
void attach_counts(Trace& trace, std::vector<std::string>& headers) {
  for (std::size_t i = 0; i < trace.channels.size(); ++i) {
    Channel& counts = trace.channels[i];
    if (counts.quantity != "code") continue;
    counts.raw = counts_of(counts.value);
    const auto physical = std::find_if(trace.channels.begin(), trace.channels.end(), [&](const Channel& c) {
      return &c != &counts && c.name == counts.name && c.quantity != "code";
    });
    if (physical == trace.channels.end() || counts.raw.empty()) continue;
    physical->raw = std::move(counts.raw);
    headers.erase(headers.begin() + static_cast<std::ptrdiff_t>(i));
    trace.channels.erase(trace.channels.begin() + static_cast<std::ptrdiff_t>(i--));
  }
}

std::string hint_for_clock(const std::string& cell) {
  const std::string general = "write seconds, 10:31:07.25 or 2024-05-31T10:31:07";
  const bool one_colon = std::ranges::count(cell, ':') == 1 && cell.find_first_not_of("0123456789:.,") == std::string::npos;
  return one_colon ? general + "; " + cell + " may be minutes or hours (a spreadsheet hides the hours: format the column as [h]:mm:ss.000 before it is saved)" : general;
}

// A clock, force or output that holds text is no column to leave out.
Result<void> check_text_columns(const CsvTable& table, const std::string& where, const CsvOptions& options) {
  for (const TextColumn& column : table.text_columns) {
    const auto mapped = options.column_map.find(column.header);
    const ColumnMeaning meaning = mapped != options.column_map.end() ? meaning_of_target(mapped->second) : meaning_of(column.header);
    const std::string known = known_name(meaning.name);
    if (!meaning.is_clock && known != "F_ref" && known != "U") continue;
    return fail(ErrorCode::parse, "column \"" + column.header + "\" holds \"" + column.cell + "\", which is no number",
                where + ":" + std::to_string(column.line) + ":" + std::to_string(column.position),
                meaning.is_clock && !column.hint.starts_with("the decimals") && !column.hint.starts_with(kWhichIsTheMonth) && !column.hint.starts_with(kNoSuchTime) && !column.hint.starts_with(kTypographicMinus) ? hint_for_clock(column.cell) : column.hint);
  }
  return {};
}

// "min" may be a minimum, "h" a height.
bool is_called_by_time(std::string_view header) { return header == "s" || header == "ms" || header == "us"; }

std::vector<ColumnMeaning> meanings_of(const CsvTable& table, const CsvOptions& options, TraceFile& out) {
  std::vector<ColumnMeaning> meanings;
  for (const CsvColumn& column : table.columns) {
    ColumnMeaning meaning = meaning_of(column.header);
    auto mapped = options.column_map.find(column.header);
    // as notes and errors write it, unless another column is really called so
    for (const std::string& alias :
         {header_of(meaning.name, meaning.unit.symbol), header_of(meaning.name, meaning.unit.canonical),
          header_of(known_name(meaning.name), meaning.unit.canonical)})
      if (mapped == options.column_map.end() &&
          std::ranges::find(table.columns, alias, &CsvColumn::header) == table.columns.end())
        mapped = options.column_map.find(alias);
    if (mapped != options.column_map.end()) {
      meaning = mapped_meaning(column.header, meaning.unit, mapped->second, out.notes);
      const std::string unknown = unknown_unit(column.header);
      if (!unknown.empty() && meaning.unit.symbol == meaning.unit.canonical && !meaning.unit.symbol.empty())
        out.notes.push_back("\"" + unknown + "\" of column \"" + column.header + "\" is no unit known here: it was read as " + meaning.unit.symbol);
      out.mapped.push_back(mapped->first);
    } else if (is_called_by_time(column.header)) {
      meaning.unit = *find_unit(column.header);
      meaning.note.clear();
    }
    if (column.dates) {  // "Time (ms)" above 10:00:00.250 tells how fine it is
      meaning.unit = *find_unit("s");
      meaning.note.clear();
    }
    if (meaning.name.empty()) meaning.name = "column_" + std::to_string(meanings.size() + 1);
    meanings.push_back(std::move(meaning));
  }
  return meanings;
}

// What --map names can be one column only: the others would be left out without a word.
Result<void> check_mapped_once(const CsvTable& table, const std::vector<ColumnMeaning>& meanings, const CsvOptions& options, const std::string& where) {
  std::map<std::string, std::string> header_of_name;
  for (std::size_t c = 0; c < meanings.size(); ++c) {
    const auto mapped = options.column_map.find(table.columns[c].header);
    if (mapped == options.column_map.end() || mapped->second == "unused") continue;
    const auto [first, is_new] = header_of_name.emplace(known_name(meanings[c].name), table.columns[c].header);
    if (!is_new)
      return fail(ErrorCode::usage, "columns \"" + first->second + "\" and \"" + table.columns[c].header + "\" are both mapped to " + first->first, where,
                  "map one of them, and the other one in another call");
  }
  return {};
}

/// Whether it rises from row to row, at this rate on the average.
bool ticks_at(double rate_Hz, const std::vector<double>& stamps, double unit_s) {
  constexpr double kAlike = 0.1;
  if (stamps.size() < 2 || std::ranges::adjacent_find(stamps, [](double a, double b) { return !(b > a); }) != stamps.end()) return false;
  const double step_s = unit_s * (stamps.back() - stamps.front()) / static_cast<double>(stamps.size() - 1);
  return std::fabs(step_s * rate_Hz - 1.0) < kAlike;
}

/// The first column that is called a clock, else the first one that holds dates or times of day, else the only one of time where no rate is
/// given or it ticks at that; the number of columns where there is none.
std::size_t find_clock(const CsvTable& table, const std::vector<ColumnMeaning>& meanings, const CsvOptions& options, std::vector<std::string>& notes) {
  const auto named = std::ranges::find_if(meanings, &ColumnMeaning::is_clock);
  if (named != meanings.end()) return static_cast<std::size_t>(named - meanings.begin());
  const auto dated = std::ranges::find_if(table.columns, &CsvColumn::dates);
  if (dated != table.columns.end()) {
    notes.push_back("column \"" + dated->header + "\" holds dates or times of day and was taken for the clock");
    return static_cast<std::size_t>(dated - table.columns.begin());
  }
  const auto counts_time = [](const ColumnMeaning& meaning) { return meaning.unit.quantity == "time" && meaning.name != "unused"; };
  if (std::ranges::count_if(meanings, counts_time) != 1) return table.columns.size();
  const auto only = static_cast<std::size_t>(std::ranges::find_if(meanings, counts_time) - meanings.begin());
  if (options.assumed_rate_Hz > 0.0 && !ticks_at(options.assumed_rate_Hz, table.columns[only].value, meanings[only].unit.factor)) return table.columns.size();
  notes.push_back("column \"" + table.columns[only].header + "\" was taken for the clock, the only time");
  return only;
}

std::vector<std::string> unused_texts(const CsvTable& table, const CsvOptions& options, TraceFile& out) {
  std::vector<std::string> headers;
  for (const TextColumn& column : table.text_columns)
    if (const auto mapped = options.column_map.find(column.header); mapped != options.column_map.end() && mapped->second == "unused") {
      headers.push_back(column.header);
      out.mapped.push_back(column.header);
    }
  return headers;
}

Result<void> settle_unit_of_clock(const CsvTable& table, std::size_t clock, std::vector<ColumnMeaning>& meanings, const std::string& where,
                                  const CsvOptions& options, std::vector<std::string>& notes) {
  if (clock == table.columns.size() || table.columns[clock].dates || meanings[clock].unit.symbol != "s") return {};
  ColumnMeaning& meaning = meanings[clock];
  FORCEGATE_TRY(const ClockUnit unit, unit_of_clock(table.columns[clock].value, table.columns[clock].header, !meaning.note.empty(), options.assumed_rate_Hz, where));
  if (unit.note.empty()) return {};
  meaning.unit.factor = unit.factor;
  meaning.note.clear();
  notes.push_back(unit.note);
  return {};
}

// SCPI-1999, 7.2.1: 9.9e37 is an instrument's overload and 9.91e37 its "not a number"; none measures more.
void empty_overloads(CsvTable& table, std::size_t clock, std::vector<std::string>& notes) {
  constexpr double kOverload = 9.89e37;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c == clock) continue;
    std::size_t over = 0;
    for (double& v : table.columns[c].value)
      if (std::fabs(v) >= kOverload) v = kMissing, ++over;
    table.columns[c].missing += over;
    if (over > 0)
      notes.push_back("column \"" + table.columns[c].header + "\": " + std::to_string(over) + std::string(kOverloadsLeftOut) + ", and count as missing");
  }
}

void convert_units(CsvTable& table, const std::vector<ColumnMeaning>& meanings, std::vector<std::string>& notes) {
  std::vector<std::string> assumed;
  for (const ColumnMeaning& meaning : meanings)
    if (!meaning.note.empty()) assumed.push_back(meaning.name + " in " + meaning.unit.symbol);
  if (!assumed.empty())
    notes.push_back("no unit is given: " + join(assumed, ", ") + (assumed.size() > 1 ? " were assumed" : " was assumed"));
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Unit& unit = meanings[c].unit;
    if (unit.factor == 1.0 && unit.offset == 0.0) continue;
    if (unit.symbol != unit.canonical && unit.symbol != "pct")  // a share is shown in percent again
      notes.push_back("column \"" + table.columns[c].header + "\" was converted from " + unit.symbol + " to " + unit.canonical);
    for (double& v : table.columns[c].value) v = unit.factor * v + unit.offset;
  }
}

// 9999, -999: no measured value, but what loggers write where they have none.
bool is_word_for_nothing(double v) {
  const double size = std::fabs(v);
  return size == 999.0 || size == 9999.0 || size == 99999.0 || size == 999999.0;
}

/// Lowest and highest sample, where more than a thousandth of them lie beyond +-`limit`.
std::optional<std::pair<double, double>> beyond(const Channel* channel, const char* unit, double limit) {
  if (channel == nullptr || channel->unit != unit) return std::nullopt;
  const std::vector<double>& values = channel->value;
  const auto far = std::ranges::count_if(values, [&](double v) { return std::fabs(v) > limit && !is_word_for_nothing(v); });
  if (static_cast<std::size_t>(far) * 1000 <= values.size()) return std::nullopt;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const double v : values)
    if (!std::isnan(v) && !is_word_for_nothing(v)) low = std::min(low, v), high = std::max(high, v);
  return std::pair{low, high};
}

/// An output of thousands of volts is one of millivolts, and the force beside it hardly in newtons.
void note_unlikely_sizes(const Trace& trace, const std::vector<std::string>& headers, std::vector<std::string>& notes) {
  constexpr double kMost_V = 100.0, kMuch_N = 500.0, kMost_N = 1e5;
  const auto note = [&](const char* name, const char* unit, const std::pair<double, double>& range, const char* why, const char* thousandth) {
    const std::string& header = headers[static_cast<std::size_t>(trace.find(name) - trace.channels.data())];
    notes.push_back("column \"" + header + "\" runs from " + plain_number(range.first) + " to " + plain_number(range.second) + " " + unit + ", " + why + "; if it is in " + thousandth + ": --map " +
                    shell_quoted(header + "=" + name + "_" + thousandth));
  };
  const auto volts = beyond(trace.find("U"), "V", kMost_V);
  if (volts) note("U", "V", *volts, "which no converter reads", "mV");
  if (const auto newtons = beyond(trace.find("F_ref"), "N", volts ? kMuch_N : kMost_N)) note("F_ref", "N", *newtons, "much for such a sensor", "mN");
}

}  // namespace

Result<TraceFile> trace_of_table(CsvTable table, const std::string& where, const std::string& name,
                                 const CsvOptions& options) {
  TraceFile out;
  out.notes = std::move(table.notes);
  out.trace.name = name;
  out.header_line = table.header_line;
  FORCEGATE_CHECK_OK(check_one_sensor(table, [&](const std::string& header) { return options.column_map.contains(header); }, where));
  std::vector<ColumnMeaning> meanings = meanings_of(table, options, out);
  FORCEGATE_CHECK_OK(check_mapped_once(table, meanings, options, where));
  const std::size_t clock_column = find_clock(table, meanings, options, out.notes);
  add_dates(table.text_columns, clock_column < table.columns.size() ? &table.columns[clock_column] : nullptr, unused_texts(table, options, out), out.notes);
  FORCEGATE_CHECK_OK(check_text_columns(table, where, options));
  FORCEGATE_CHECK_OK(settle_unit_of_clock(table, clock_column, meanings, where, options, out.notes));
  if (const int bits = clock_column < table.columns.size() ? count_on(table.columns[clock_column].value) : 0; bits > 0)
    out.notes.push_back("the clock \"" + table.columns[clock_column].header + "\" passes 2^" + std::to_string(bits) + ", where a counter of " + std::to_string(bits) + " bits begins anew; counted on");
  empty_overloads(table, clock_column, out.notes);
  convert_units(table, meanings, out.notes);

  Clock clock;
  if (clock_column < table.columns.size()) {
    ClockSource source{where, table.columns[clock_column].header, {}, options.assumed_rate_Hz, table.columns[clock_column].dates, table.columns[clock_column].zoned, {}, {}};
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      if (c != clock_column) source.columns.push_back(&table.columns[c].value);
    source.changes_at = [&](std::size_t row) { return column_that_changes_at(table, row); };
    if (table.header_line > 0) source.line_of_row = [&](std::size_t row) { return table.line_of_row(row); };
    auto made = make_clock(std::move(table.columns[clock_column].value), source);
    if (!made) return tl::unexpected(made.error());
    clock = std::move(*made);
    out.notes.insert(out.notes.end(), clock.notes.begin(), clock.notes.end());
  } else {
    if (!(options.assumed_rate_Hz > 0.0)) return no_clock(table, meanings, where);
    clock.base = invented_clock(table.rows(), options.assumed_rate_Hz);
    out.notes.push_back("the file has no clock; " + shortest(options.assumed_rate_Hz) + " Hz was assumed");
  }
  out.trace.time_bases.push_back(std::move(clock.base));

  std::vector<std::string> headers;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c == clock_column) continue;
    headers.push_back(table.columns[c].header.empty() ? header_of(meanings[c].name, meanings[c].unit.canonical) : table.columns[c].header);
    Channel channel;
    channel.name = std::move(meanings[c].name);
    channel.unit = meanings[c].unit.canonical;
    channel.quantity = meanings[c].unit.quantity;
    channel.value = std::move(table.columns[c].value);
    if (!clock.rows.empty()) keep_rows(channel.value, clock.rows);
    const bool nothing = table.columns[c].header.empty() && table.columns[c].missing == channel.value.size();  // a spreadsheet's empty column
    if (table.columns[c].missing > 0 && !nothing)
      out.notes.push_back("column \"" + table.columns[c].header + "\" misses " +
                          std::to_string(table.columns[c].missing) + " of " +
                          std::to_string(channel.value.size()) + " samples");
    out.trace.channels.push_back(std::move(channel));
  }
  for (std::string& note : use_canonical_names(out.trace, headers)) out.notes.push_back(std::move(note));
  note_unlikely_sizes(out.trace, headers, out.notes);
  attach_counts(out.trace, headers);
  make_names_unique(out.trace);
  for (std::size_t i = 0; i < headers.size(); ++i) out.headers.emplace(out.trace.channels[i].name, std::move(headers[i]));
  if (const auto output = out.headers.find("U"); output != out.headers.end()) table.above.push_back(output->second);
  out.sensor = only_sensor_named(table.above);
  return out;
}

Result<TraceFile> read_csv(const std::filesystem::path& path, const CsvOptions& options) {
  FORCEGATE_TRY(CsvTable table, read_csv_table(path));
  return trace_of_table(std::move(table), path.string(), path.stem().string(), options);
}

Result<TraceFile> parse_csv(std::string_view bytes, std::string_view name, const CsvOptions& options) {
  FORCEGATE_TRY(CsvTable table, parse_csv_table(bytes, name));
  return trace_of_table(std::move(table), std::string(name), std::string(name), options);
}

Result<void> write_csv(const Trace& trace, const std::filesystem::path& path) {
  if (trace.time_bases.size() != 1)
    return fail(
        ErrorCode::config,
        "the trace has " + std::to_string(trace.time_bases.size()) + " time bases, a CSV file holds one",
        path.string(), "write it as .h5");
  std::string header = "t_s";
  for (const Channel& c : trace.channels) {
    const std::string name = header_of(c.name, c.unit);
    header += "," + (name.find_first_of(",;\"") == std::string::npos ? name : "\"" + name + "\"");
    if (has_counts_beside(c)) header += "," + c.name + "_counts";
  }
  header += '\n';

  FORCEGATE_TRY(const std::filesystem::path target, output_path(path));
  const std::filesystem::path temporary = target.string() + ".part";
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  const auto io_error = [&](const char* what) {
    const int code = errno;
    if (file) std::fclose(file);
    std::remove(temporary.c_str());
    return fail(ErrorCode::io, std::string(what) + ": " + std::strerror(code), path.string(),
                code == ENOENT ? "create the folder first" : "check the folder, its permissions and the free space");
  };
  if (!file) return io_error("the file cannot be created");

  std::vector<char> buffer(std::size_t{1} << 20);
  std::size_t used = 0;
  const auto put = [&](char c) { buffer[used++] = c; };
  const auto put_number = [&](auto value) {
    used = static_cast<std::size_t>(
        std::to_chars(buffer.data() + used, buffer.data() + buffer.size(), value).ptr - buffer.data());
  };
  const std::size_t row_bytes = 40 * (2 * trace.channels.size() + 1) + 2;
  if (buffer.size() < 2 * row_bytes) buffer.resize(2 * row_bytes);
  bool good = std::fwrite(header.data(), 1, header.size(), file) == header.size();
  const auto& t = trace.time_bases.front().t_s;
  for (std::size_t i = 0; i < t.size() && good; ++i) {
    put_number(t[i]);
    for (const Channel& c : trace.channels) {
      put(',');
      if (i < c.value.size() && std::isfinite(c.value[i])) put_number(c.value[i]);
      if (!has_counts_beside(c)) continue;
      put(',');
      if (i < c.raw.size() && c.raw[i] != kMissingCount) put_number(c.raw[i]);
    }
    put('\n');
    if (used + row_bytes > buffer.size()) {
      good = std::fwrite(buffer.data(), 1, used, file) == used;
      used = 0;
    }
  }
  good = good && std::fwrite(buffer.data(), 1, used, file) == used && std::fflush(file) == 0;
  if (!good) return io_error("the file cannot be written");
  std::fclose(file);
  std::error_code failed;
  std::filesystem::rename(temporary, target, failed);
  if (failed) {
    std::remove(temporary.c_str());
    return fail(ErrorCode::io, "the file cannot be given its name: " + failed.message(), path.string(), "check the folder and its permissions");
  }
  return {};
}

}  // namespace forcegate
