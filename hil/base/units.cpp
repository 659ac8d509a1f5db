#include "hil/base/units.h"

#include <array>
#include <numbers>

namespace forcegate {
namespace {

struct Row {
  const char* symbol;
  const char* canonical;
  const char* quantity;
  double factor;
  double offset;
};

constexpr std::array kTable = {
    Row{"s", "s", "time", 1, 0},
    Row{"ms", "s", "time", 1e-3, 0},
    Row{"us", "s", "time", 1e-6, 0},
    Row{"ns", "s", "time", 1e-9, 0},
    Row{"min", "s", "time", 60, 0},
    Row{"h", "s", "time", 3600, 0},
    Row{"days", "s", "time", 86400, 0},
    Row{"N", "N", "force", 1, 0},
    Row{"mN", "N", "force", 1e-3, 0},
    Row{"uN", "N", "force", 1e-6, 0},
    Row{"cN", "N", "force", 1e-2, 0},
    Row{"kN", "N", "force", 1e3, 0},
    Row{"daN", "N", "force", 10.0, 0},
    Row{"gf", "N", "force", 9.80665e-3, 0},
    Row{"kgf", "N", "force", 9.80665, 0},
    Row{"kg", "N", "force", 9.80665, 0},  // what a weight or a cell of a balance is labelled with
    Row{"lbf", "N", "force", 4.4482216152605, 0},
    Row{"ozf", "N", "force", 0.27801385095378125, 0},
    Row{"V", "V", "voltage", 1, 0},
    Row{"mV", "V", "voltage", 1e-3, 0},
    Row{"uV", "V", "voltage", 1e-6, 0},
    Row{"kV", "V", "voltage", 1e3, 0},
    Row{"counts", "counts", "code", 1, 0},
    Row{"codes", "counts", "code", 1, 0},
    Row{"lsb", "counts", "code", 1, 0},
    Row{"rad", "rad", "angle", 1, 0},
    Row{"mrad", "rad", "angle", 1e-3, 0},
    Row{"deg", "rad", "angle", std::numbers::pi / 180, 0},
    Row{"rev", "rad", "angle", 2 * std::numbers::pi, 0},
    Row{"C", "C", "temperature", 1, 0},
    Row{"degC", "C", "temperature", 1, 0},
    Row{"K", "C", "temperature", 1, -273.15},
    Row{"degF", "C", "temperature", 5.0 / 9.0, -160.0 / 9.0},
    Row{"F", "F", "capacitance", 1, 0},
    Row{"nF", "F", "capacitance", 1e-9, 0},
    Row{"pF", "F", "capacitance", 1e-12, 0},
    Row{"uF", "F", "capacitance", 1e-6, 0},
    Row{"Hz", "Hz", "frequency", 1, 0},
    Row{"kHz", "Hz", "frequency", 1e3, 0},
    Row{"m", "m", "length", 1, 0},
    Row{"cm", "m", "length", 1e-2, 0},
    Row{"mm", "m", "length", 1e-3, 0},
    Row{"um", "m", "length", 1e-6, 0},
    Row{"ohm", "ohm", "resistance", 1, 0},
    Row{"kohm", "ohm", "resistance", 1e3, 0},
    Row{"Mohm", "ohm", "resistance", 1e6, 0},
    Row{"S", "S", "conductance", 1, 0},
    Row{"mS", "S", "conductance", 1e-3, 0},
    Row{"uS", "S", "conductance", 1e-6, 0},
    Row{"nS", "S", "conductance", 1e-9, 0},
    Row{"Pa", "Pa", "pressure", 1, 0},
    Row{"kPa", "Pa", "pressure", 1e3, 0},
    Row{"MPa", "Pa", "pressure", 1e6, 0},
    Row{"bar", "Pa", "pressure", 1e5, 0},
    Row{"mbar", "Pa", "pressure", 1e2, 0},
    Row{"hPa", "Pa", "pressure", 1e2, 0},
    Row{"pct", "1", "ratio", 1e-2, 0},
    Row{"A", "A", "current", 1, 0},
    Row{"mA", "A", "current", 1e-3, 0},
    Row{"uA", "A", "current", 1e-6, 0},
    Row{"nA", "A", "current", 1e-9, 0},
};

// Names of units, in which case tells nothing; a plural has one letter more.
struct Word {
  std::string_view text;
  const char* symbol;
};
constexpr std::array kWords = {
    Word{"sec", "s"},           Word{"second", "s"},       Word{"msec", "ms"},      Word{"millisecond", "ms"}, Word{"usec", "us"},
    Word{"microsecond", "us"},  Word{"minute", "min"},     Word{"hour", "h"},       Word{"newton", "N"},       Word{"millinewton", "mN"},
    Word{"kilonewton", "kN"},   Word{"lb", "lbf"},         Word{"lbf", "lbf"},       Word{"ozf", "ozf"},        Word{"kgf", "kgf"},
    Word{"gf", "gf"},           Word{"gram", "gf"},         Word{"volt", "V"},       Word{"millivolt", "mV"},   Word{"microvolt", "uV"},
};

bool is_word(std::string_view symbol, std::string_view word) {
  if (symbol.size() > word.size() + 3) return false;
  std::string lower;
  for (const char c : symbol) lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c | 0x20) : c;
  return lower == word || lower == std::string(word) + "s" || lower == std::string(word) + "(s)";
}

}  // namespace

std::optional<Unit> find_unit(std::string_view symbol) {
  // the sign for micro, of which Unicode has two
  for (const std::string_view micro : {"\xC2\xB5", "\xCE\xBC"})
    if (symbol.starts_with(micro)) return find_unit("u" + std::string(symbol.substr(micro.size())));
  // the degree sign, and the ordinal that passes for it
  for (const std::string_view degree : {"\xC2\xB0", "\xC2\xBA"})
    if (symbol.starts_with(degree)) return find_unit("deg" + std::string(symbol.substr(degree.size())));
  // the letter and the sign for ohm, which Unicode parts, and the name itself
  for (const std::string_view ohm : {"\xCE\xA9", "\xE2\x84\xA6", "Ohm"})
    if (symbol.ends_with(ohm)) return find_unit(std::string(symbol.substr(0, symbol.size() - ohm.size())) + "ohm");
  for (const std::string_view percent : {"%", "%RH", "% RH", "percent"})
    if (symbol == percent) return find_unit("pct");
  for (const Row& row : kTable)
    if (symbol == row.symbol) return Unit{row.symbol, row.canonical, row.quantity, row.factor, row.offset};
  for (const Word& word : kWords)
    if (is_word(symbol, word.text)) return find_unit(word.symbol);
  return std::nullopt;
}

std::optional<NamedColumn> split_unit_suffix(std::string_view column) {
  const std::size_t at = column.rfind('_');
  if (at == std::string_view::npos || at == 0) return std::nullopt;
  const auto unit = find_unit(column.substr(at + 1));
  if (!unit) return std::nullopt;
  return NamedColumn{std::string(column.substr(0, at)), *unit};
}

}  // namespace forcegate
