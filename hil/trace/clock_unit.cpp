#include "hil/trace/clock_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

struct Fraction {
  const char* symbol;
  const char* name;
  double factor;
};
constexpr std::array kFractions = {Fraction{"ms", "milliseconds", 1e-3}, Fraction{"us", "microseconds", 1e-6}, Fraction{"ns", "nanoseconds", 1e-9}};

struct Numbers {
  double first = NAN, step = 0.0;  ///< median of the steps that are none of 0
  bool whole = true;
};

Numbers numbers_of(const std::vector<double>& stamps) {
  Numbers out;
  std::vector<double> steps;
  double before = NAN;
  for (const double t : stamps) {
    if (!std::isfinite(t)) continue;
    if (std::isnan(out.first)) out.first = t;
    out.whole = out.whole && t == std::floor(t);
    if (t != before && std::isfinite(before)) steps.push_back(std::fabs(t - before));
    before = t;
  }
  if (steps.empty()) return out;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  out.step = *middle;
  return out;
}

std::string map_to(const std::string& column, const std::string& unit) { return "--map " + shell_quoted(column + "=t_" + unit); }

}  // namespace

Result<ClockUnit> unit_of_clock(const std::vector<double>& stamps, const std::string& column, bool assumed, double declared_rate_Hz, const std::string& where) {
  constexpr double kBeyondDates_s = 1e11, kFirst_s = 946684800.0, kLast_s = 4102444800.0;  // the years 5138, 2000, 2100
  constexpr double kFewestApart = 2.0, kAgrees = 1.25;
  constexpr double kFirstDay = 36526.0, kLastDay = 73051.0, kDense_s = 1e-3;  // the same years in a spreadsheet
  const Numbers numbers = numbers_of(stamps);
  if (std::fabs(numbers.first) >= kBeyondDates_s) {
    for (const Fraction& unit : kFractions)
      if (const double first_s = unit.factor * numbers.first; first_s >= kFirst_s && first_s < kLast_s)
        return ClockUnit{unit.factor, fmt::format("the clock \"{}\" begins at {:.0f}, which cannot be seconds: it was read as {} since 1970", column, numbers.first, unit.name)};
    return fail(ErrorCode::parse, fmt::format("the clock \"{}\" begins at {}, which cannot be seconds", column, shortest(numbers.first)), where,
                "say its unit, for instance " + map_to(column, "us") + " where it counts microseconds");
  }
  if (!assumed || !(numbers.step > 0.0)) return ClockUnit{};
  if (numbers.whole && numbers.step >= kFewestApart) {
    const auto agrees = [&](double factor) {
      const double ratio = declared_rate_Hz * factor * numbers.step;
      return ratio > 1.0 / kAgrees && ratio < kAgrees;
    };
    if (agrees(1.0)) return ClockUnit{};
    for (const Fraction& unit : kFractions)
      if (agrees(unit.factor)) return ClockUnit{unit.factor, fmt::format("the clock \"{}\" was read as {}, which agrees with {} Hz", column, unit.name, shortest(declared_rate_Hz))};
    const Fraction& likely = numbers.step < 2e3 ? kFractions[0] : numbers.step < 2e6 ? kFractions[1] : kFractions[2];
    return ClockUnit{1.0, fmt::format("the clock \"{}\" was taken for seconds, a sample every {} s; if it counts {}: {} (seconds: {})", column, plain_number(numbers.step), likely.name,
                                      map_to(column, likely.symbol), map_to(column, "s"))};
  }
  if (numbers.first >= kFirstDay && numbers.first < kLastDay && numbers.step < kDense_s)
    return ClockUnit{1.0, fmt::format("the clock \"{}\" was taken for seconds; if it counts days, as a spreadsheet does: {}", column, map_to(column, "days"))};
  return ClockUnit{};
}

}  // namespace forcegate
