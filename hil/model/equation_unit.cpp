#include "hil/model/equation_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include "hil/base/units.h"

namespace forcegate {
namespace {

// "N/s^2" -> N, s
std::vector<std::string> symbols_of(const std::string& unit) {
  std::vector<std::string> out{""};
  for (const char c : unit) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalpha(byte) != 0 || byte >= 0x80 || c == '%' || c == '_') out.back() += c;
    else out.emplace_back();
  }
  std::erase(out, "");
  return out;
}

bool is_of_equations(const std::string& symbol) {
  constexpr std::array kBase = {"N", "s", "degC", "K", "rad", "Hz"};  // a difference in K is one in degC
  const auto known = find_unit(symbol);
  const bool as_stored = known && known->factor == 1.0 && known->offset == 0.0;
  return std::ranges::find(kBase, symbol) != kBase.end() || (as_stored && (known->quantity == "temperature" || std::ranges::find(kBase, known->canonical) != kBase.end()));
}

}  // namespace

Result<void> check_unit_of_equations(const ModelParameter& p, const std::string& place) {
  const std::vector<std::string> symbols = symbols_of(p.unit);
  if (std::ranges::all_of(symbols, is_of_equations)) return {};
  std::string help = "convert the value with its bounds and write such a unit, for instance \"1/s\" or \"N/degC\", or leave the unit out";
  if (const auto whole = find_unit(p.unit); whole && is_of_equations(whole->canonical))
    help = fmt::format("write {} = {{ value = {:g}, unit = \"{}\" }}, and bounds in {} too", p.name, whole->factor * p.value + whole->offset, whole->canonical, whole->canonical);
  return fail(ErrorCode::config, fmt::format("{} is in \"{}\", and equations are written in N, s, degC and rad: nothing is converted", p.name, p.unit), place, help);
}

}  // namespace forcegate
