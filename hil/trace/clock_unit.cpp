#include "hil/trace/clock_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

struct Fraction {
  const char* symbol;
  const char* name;
  double factor;
};
constexpr std::array kFractions = {Fraction{"ms", "milliseconds", 1e-3}, Fraction{"us", "microseconds", 1e-6}, Fraction{"ns", "nanoseconds", 1e-9}};

constexpr double kFirstDay = 36526.0, kLastDay = 73051.0;  // of the years 2000 and 2100 in a spreadsheet

bool are_whole(const std::vector<double>& stamps) {
  return std::ranges::all_of(stamps, [](double t) { return !std::isfinite(t) || t == std::floor(t); });
}

/// Median of those that are not 0, out of some thousands; 0 where there is none.
double typical_step(const std::vector<double>& stamps) {
  constexpr std::size_t kMost = 4096;
  std::vector<double> steps;
  for (std::size_t i = 1, stride = stamps.size() / kMost + 1; i < stamps.size(); i += stride)
    for (std::size_t k = i; k < std::min(i + stride, stamps.size()); ++k)  // in packets most are 0
      if (const double step = std::fabs(stamps[k] - stamps[k - 1]); step > 0.0 && std::isfinite(step)) {
        steps.push_back(step);
        break;
      }
  return steps.empty() ? 0.0 : median(std::move(steps));
}

constexpr const char* kHardlyMeant = ", which is hardly meant";
constexpr const char* kOfSeconds = " (seconds: ";

std::string map_to(const std::string& column, const std::string& unit) { return "--map " + shell_quoted(column + "=t_" + unit); }

}  // namespace

Result<ClockUnit> unit_of_clock(const std::vector<double>& stamps, const std::string& column, bool assumed, double declared_rate_Hz, const std::string& where) {
  constexpr double kBeyondDates_s = 1e11, kFirst_s = 946684800.0, kLast_s = 4102444800.0;  // the years 5138, 2000, 2100
  constexpr double kFewestApart = 2.0, kAgrees = 1.25;
  constexpr double kHardly_s = 1e3;
  constexpr double kDense_s = 1e-3, kTooDense_s = 2e-5;
  const auto found = std::ranges::find_if(stamps, [](double t) { return std::isfinite(t); });
  const double first = found != stamps.end() ? *found : 0.0;
  if (std::fabs(first) >= kBeyondDates_s) {
    for (const Fraction& unit : kFractions)
      if (const double first_s = unit.factor * first; first_s >= kFirst_s && first_s < kLast_s)
        return ClockUnit{unit.factor, fmt::format("the clock \"{}\" begins at {:.0f}, which cannot be seconds: it was read as {} since 1970", column, first, unit.name)};
    return fail(ErrorCode::parse, fmt::format("the clock \"{}\" begins at {}, which cannot be seconds", column, shortest(first)), where,
                "say its unit, for instance " + map_to(column, "us") + " where it counts microseconds");
  }
  const bool whole = are_whole(stamps), in_days = first >= kFirstDay && first < kLastDay;
  const bool of_one_day = assumed && !whole && std::ranges::all_of(stamps, [](double t) {
                            return !std::isfinite(t) || (t >= 0.0 && t < 1.0);
                          });  // times of day in a spreadsheet
  if (!assumed && !in_days) return ClockUnit{};
  if (!whole && !in_days && !of_one_day) return ClockUnit{};
  const double step = typical_step(stamps);
  if (assumed && whole && step >= kFewestApart) {
    const auto agrees = [&](double factor) {
      const double ratio = declared_rate_Hz * factor * step;
      return ratio > 1.0 / kAgrees && ratio < kAgrees;
    };
    if (agrees(1.0)) return ClockUnit{};
    for (const Fraction& unit : kFractions)
      if (agrees(unit.factor))
        return ClockUnit{unit.factor, fmt::format("the clock \"{}\" was read as {}, which agrees with {} Hz", column, unit.name,
                                                  shortest(declared_rate_Hz))};
    const Fraction& likely = step < 2e3 ? kFractions[0] : step < 2e6 ? kFractions[1] : kFractions[2];
    return ClockUnit{1.0, fmt::format("the clock \"{}\" was taken for seconds, a sample every {} s{}; if it counts {}: {}{}{})",
                                      column, plain_number(step), step >= kHardly_s ? kHardlyMeant : "", likely.name, map_to(column, likely.symbol), kOfSeconds,
                                      map_to(column, "s"))};
  }
  if ((in_days && step > 0.0 && step < (assumed ? kDense_s : kTooDense_s)) || (of_one_day && step > 0.0 && step < kTooDense_s))
    return ClockUnit{1.0, fmt::format("the clock \"{}\" was taken for seconds; if it counts days, as a spreadsheet does: {}", column, map_to(column, "days"))};
  return ClockUnit{};
}

std::string map_of_clock(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    const std::size_t said = note.find(kHardlyMeant), map = note.find("--map ", said == std::string::npos ? note.size() : said), end = note.rfind(kOfSeconds);
    if (map < end && end != std::string::npos) return note.substr(map, end - map);
  }
  return {};
}

bool may_count_days(const std::vector<double>& stamps) {
  constexpr double kApart_days = 1e-3;
  const bool dates = std::ranges::all_of(stamps, [](double t) { return !std::isfinite(t) || (t >= kFirstDay && t < kLastDay); });
  const double step = dates ? typical_step(stamps) : 0.0;
  return step > 0.0 && step < kApart_days;
}

namespace {

/// Of whole numbers below `turn` those behind one; `longest`: the step across it, at most.
bool count_on(std::vector<double>& stamps, double turn, double longest) {
  for (std::size_t i = 0; i < stamps.size(); ++i)
    if (std::isfinite(stamps[i]) && !(stamps[i] >= 0.0 && stamps[i] < turn && stamps[i] == std::floor(stamps[i]))) return false;
  double before = 0.0, turns = 0.0;
  for (double& t : stamps) {
    if (!std::isfinite(t)) continue;
    if (before - t > 0.5 * turn && t + turn - before <= longest) turns += 1.0;
    before = t;
    t += turns * turn;
  }
  return turns > 0.0;
}

}  // namespace

int count_on(std::vector<double>& stamps) {
  constexpr double kFewSteps = 2.0, kSteps = 100.0;  // in 16 bits a recording that begins anew is easily taken for one that goes on
  const double step = typical_step(stamps);
  return count_on(stamps, 65536.0, kFewSteps * step) ? 16 : count_on(stamps, 4294967296.0, kSteps * step) ? 32 : 0;
}

}  // namespace forcegate
