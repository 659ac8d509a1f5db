#include "hil/trace/column_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hil/base/plain_number.h"
#include "hil/base/read_number.h"
#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/trace/channels.h"
#include "hil/trace/columns.h"
#include "hil/trace/compression.h"
#include "hil/trace/convert.h"
#include "hil/trace/csv_hints.h"

namespace forcegate {
namespace {

// Who maps Sensor_mV to U_V gives the column a name and means millivolts: a plain SI unit of the name gives way to the header's of the
// same quantity.
ColumnMeaning renamed(const Unit& of_header, ColumnMeaning name) {
  const bool plain = name.unit.symbol == name.unit.canonical;
  if (plain && !of_header.symbol.empty() && of_header.quantity == name.unit.quantity) name.unit = of_header;
  return name;
}

// A position that stands for the output keeps its numbers. A name with a unit of its own that is no plain SI unit says what the column holds.
bool is_another_quantity(const Unit& of_header, const ColumnMeaning& wanted) {
  return !of_header.quantity.empty() && !wanted.unit.quantity.empty() && of_header.quantity != wanted.unit.quantity &&
         wanted.unit.symbol == wanted.unit.canonical && !wanted.is_clock && of_header.quantity != "code";
}

template <std::size_t N>
bool has_word(std::string_view name, const std::array<const char*, N>& words) {
  const std::string lower = ascii_lower(name);
  for (std::size_t begin = 0, end = 0; begin < lower.size(); begin = end + 1) {
    end = std::min(lower.find_first_of(" _-.()[]", begin), lower.size());
    if (std::ranges::find(words, std::string_view(lower).substr(begin, end - begin)) != words.end()) return true;
  }
  return false;
}

// "ADC code", "Lectura_ADC", "raw": a number of a converter by one word of the name.
bool is_called_code(std::string_view name) { return has_word(name, std::array{"adc", "code", "codes", "count", "counts", "lsb", "raw", "digits"}); }

// "A0" to "A15": an analog pin of an Arduino, whose reading is whole.
bool is_reading_of_pin(const Channel& c) {
  const bool pin = c.name.size() > 1 && c.name.size() < 4 && c.name[0] == 'A' && c.name.find_first_not_of("0123456789", 1) == std::string::npos;
  return pin && std::ranges::all_of(c.value, [](double v) { return std::isnan(v) || (v >= 0.0 && v == std::floor(v)); });
}

bool is_called_load_cell(std::string_view name) { return has_word(name, std::array{"hx711", "load", "loadcell", "cell", "force", "scale", "weight"}); }

// What a cell is multiplied by, after its reading at zero is taken off.
struct Scale {
  double factor = 1.0, zero = 0.0;
};

// "0.0046" or "1/21543"
std::optional<double> factor_of(std::string_view text) {
  const std::size_t slash = text.find('/');
  const std::optional<double> above = read_number(text.substr(0, slash)), below = slash == std::string_view::npos ? 1.0 : read_number(text.substr(slash + 1));
  if (!above || !below || *above == 0.0 || *below == 0.0) return std::nullopt;
  return *above / *below;
}

// nullopt: what stands behind the name is no scale
std::optional<Scale> scale_of(std::string_view to) {
  const std::size_t colon = to.find(':');
  if (colon == std::string_view::npos) return Scale{};
  const std::string_view numbers = to.substr(colon + 1);
  const std::size_t second = numbers.find(':');
  const std::optional<double> factor = factor_of(numbers.substr(0, second)), zero = second == std::string_view::npos ? 0.0 : read_number(numbers.substr(second + 1));
  return factor && zero ? std::optional(Scale{*factor, *zero}) : std::nullopt;
}

std::vector<const Channel*> columns_left(const Trace& trace) {
  std::vector<const Channel*> out;
  for (const Channel& c : trace.channels)
    if (known_channel(c.name) == nullptr) out.push_back(&c);
  return out;
}

std::string name_of_target(const std::string& to) { return to.substr(0, to.find(':')); }

}  // namespace

ColumnMeaning meaning_of_target(const std::string& to) { return meaning_of(name_of_target(to)); }

Result<ColumnMap> parse_column_map(std::span<const std::string> words) {
  ColumnMap out;
  for (const std::string& word : words) {
    const std::size_t equals = word.rfind('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == word.size())
      return fail(ErrorCode::usage, "\"" + printable_utf8(word) + "\" is not COLUMN=NAME", "--map", "write for example --map \"Load cell=F_ref_N\"");
    const std::string to = word.substr(equals + 1);
    if (!scale_of(to) || to.front() == ':')
      return fail(ErrorCode::usage, in_quotes(to) + " is no NAME, NAME:FACTOR or NAME:FACTOR:ZERO", "--map " + printable_utf8(word),
                  "a load cell of 21543 counts per newton that reads 84211 without load is F_ref_N:1/21543:84211");
    if (to.find(':') != std::string::npos && meaning_of_target(to).unit.symbol.empty())
      return fail(ErrorCode::usage, in_quotes(name_of_target(to)) + " names no unit, and the factor makes one", "--map " + printable_utf8(word), "for instance F_ref_N");
    out[word.substr(0, equals)] = to;
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
                "there are " + some_columns(columns) + (meaning_of_target(to).is_clock ? "; the clock of an HDF5 file stays what it is" : ""));
  }
  return {};
}

ColumnMeaning mapped_meaning(const std::string& header, const Unit& of_header, const std::string& to, std::vector<std::string>& notes) {
  const auto called = find_unit(header);  // a column of kilograms-force that is called kgf
  ColumnMeaning wanted = meaning_of_target(to);
  if (to.find(':') != std::string::npos) {
    const Scale scale = scale_of(to).value_or(Scale{});
    wanted.unit.factor *= scale.factor;
    wanted.unit.offset -= wanted.unit.factor * scale.zero;
    notes.push_back("column \"" + header + "\" was read as " + plain_number(scale.factor) + " " + wanted.unit.symbol + " a unit of it, from " + plain_number(scale.zero) + " on");
    return wanted;
  }
  const Unit& header_unit = of_header.symbol.empty() && called ? *called : of_header;
  ColumnMeaning meaning = renamed(header_unit, wanted);
  if (called && meaning.unit.symbol == called->symbol && meaning.unit.symbol != wanted.unit.symbol)
    notes.push_back("column \"" + header + "\" was read in " + meaning.unit.symbol + ", as it is called");
  else if (called && meaning.unit.symbol != called->symbol && meaning.unit.quantity == called->quantity)
    notes.push_back("column \"" + header + "\" was read in " + meaning.unit.symbol + ", though it is called " + called->symbol);
  if (is_another_quantity(header_unit, wanted))
    notes.push_back("column \"" + header + "\" is in " + header_unit.symbol + " and was read as " + wanted.unit.symbol + ", as --map says: wherever " + wanted.unit.symbol +
                    " stands, " + header_unit.symbol + " is meant");
  return meaning;
}

void map_channels(TraceFile& file, const ColumnMap& map) {
  for (Channel& c : file.trace.channels) {
    const std::string header = header_of(c.name, c.unit);
    const auto mapped = map.find(header);
    if (mapped == map.end() || meaning_of_target(mapped->second).is_clock) continue;
    const Unit stored = find_unit(c.unit).value_or(Unit{.symbol = c.unit, .canonical = c.unit, .quantity = c.quantity});
    const ColumnMeaning meaning = mapped_meaning(header, stored, mapped->second, file.notes);
    const Unit& unit = meaning.unit;
    if (unit.symbol != unit.canonical) file.notes.push_back("column \"" + header + "\" was converted from " + unit.symbol + " to " + unit.canonical);
    if (unit.factor != 1.0 || unit.offset != 0.0)
      for (double& v : c.value) v = unit.factor * v + unit.offset;
    if (c.quantity == "code" && unit.quantity != "code") c.raw.clear();
    c.name = known_name(meaning.name);
    c.unit = unit.canonical;
    c.quantity = unit.quantity;
    file.mapped.push_back(header);
  }
  if (!file.mapped.empty()) make_names_unique(file.trace);
}

Result<TraceFile> read_mapped_trace(const std::filesystem::path& path, std::string_view map, double assumed_rate_Hz) {
  std::vector<std::string> words;
  if (!map.empty()) words = split(map, '\n');
  FORCEGATE_TRY(const ColumnMap columns, parse_column_map(words));
  FORCEGATE_TRY(TraceFile file, read_trace(path, {columns, assumed_rate_Hz}));
  const Trace* const only[] = {&file.trace};
  FORCEGATE_CHECK_OK(check_column_map(columns, file.mapped, only, path));
  turn_compression_over(file);
  return file;
}

std::string written_header(const Channel& channel, const std::map<std::string, std::string>& headers) {
  const auto written = headers.find(channel.name);
  if (written != headers.end() && !written->second.empty()) return written->second;
  const bool tells_unit = !channel.unit.empty() && channel.name.ends_with("_" + channel.unit);  // the second channel of one name
  return tells_unit ? channel.name : header_of(channel.name, channel.unit);
}

std::string column_map_advice(const Trace& trace, std::string_view name, std::string_view unit, const std::map<std::string, std::string>& headers) {
  const auto header = [&](const Channel& c) { return written_header(c, headers); };
  const std::string wanted(name);
  for (const Channel& c : trace.channels)
    if (const std::string meant = meant_but_for_capitals(header(c)); meant == header_of(name, unit)) return "--map " + shell_quoted(header(c) + "=" + meant);
  for (const Channel& c : trace.channels)
    if (c.unit == unit && known_channel(c.name) == nullptr)
      return "--map " + shell_quoted(header(c) + "=" + wanted + "_" + c.unit);
  if (wanted == "F_ref")
    for (const Channel& c : trace.channels)
      if ((c.unit.empty() || c.quantity == "code") && is_called_load_cell(c.name) && known_channel(c.name) == nullptr)
        return "--map " + shell_quoted(header(c) + "=F_ref_N:FACTOR:ZERO") + " where it holds counts of a load cell (newtons a count, and the reading without load)";
  for (const Channel& c : trace.channels)  // a column that is called by its unit
    if (const auto called = find_unit(c.name); c.unit.empty() && called && called->canonical == unit)
      return "--map " + shell_quoted(header(c) + "=" + wanted + "_" + c.name);
  if (wanted == "U")
    for (const Channel& c : trace.channels) {
      if (!c.unit.empty() || known_channel(c.name) != nullptr) continue;
      if (is_called_code(c.name) || is_reading_of_pin(c)) return "--map " + shell_quoted(header(c) + "=U_counts") + " where it holds codes of a converter";
      if (c.name.find('/') != std::string::npos)
        return "--map " + shell_quoted(header(c) + "=U_V") + " where it is a ratio: wherever V stands, parts of the supply are meant";
    }
  // what stands for an output, twice: whichever is taken out, the other one is it
  if (wanted == "U")
    for (const std::string_view quantity : {"resistance", "conductance", "current", "code"}) {
      std::vector<const Channel*> of_quantity;
      for (const Channel& c : trace.channels)
        if (c.quantity == quantity) of_quantity.push_back(&c);
      if (of_quantity.size() > 1)
        return "--map " + shell_quoted(header(*of_quantity.back()) + "=unused") + " where " + header(*of_quantity.front()) + " is the sensor";
    }
  const std::string any = "--map NAME=" + wanted + "_" + std::string(unit);
  const std::vector<const Channel*> free = columns_left(trace);
  return free.size() == 1 ? any + ", where \"" + shortened(header(*free.front())) + "\" is the only column left" : any;
}

std::string no_column_left_advice(const Trace& trace) {
  if (!columns_left(trace).empty()) return {};
  return "the file has no column left for it: force and output must stand in one table on one clock. What two loggers wrote goes into one file with one "
         "column of time, the rows in its order and a cell empty where the other logger took no sample (docs/campaign.md, \"Two loggers\")";
}

}  // namespace forcegate
