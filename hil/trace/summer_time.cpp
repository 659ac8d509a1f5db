#include "hil/trace/summer_time.h"

#include <algorithm>
#include <cmath>

namespace forcegate {
namespace {

constexpr double kHour_s = 3600.0, kDay_s = 86400.0;

const std::string kZones = "or write all of them with their zone (2026-10-25T02:00:00+01:00)";

// Within a step after 1, 2, 3 or 4 o'clock: the hour before it is left out somewhere on earth.
bool is_when_clocks_are_set(double t_s, double step_s) {
  constexpr double kFirst = 1.0, kLast = 4.0, kYear_s = 365.0 * kDay_s, kWeek = 7.0, kSunday = 3.0;  // 1970 began on a Thursday
  const double hour = std::floor(std::fmod(t_s, kDay_s) / kHour_s), day = std::floor(t_s / kDay_s);
  return std::fmod(t_s, kHour_s) < step_s && hour >= kFirst && hour <= kLast && (t_s < kYear_s || std::fmod(day, kWeek) == kSunday);
}

}  // namespace

std::optional<std::string> hint_for_hour_back(double back_s, double step_s) {
  constexpr double kNear_s = 5.0;
  if (std::fabs(back_s - kHour_s) > std::max(kNear_s, 2.0 * step_s)) return std::nullopt;
  return "an hour is what clocks go back at the end of summer time: add it to the stamps from there on, " + kZones;
}

std::optional<std::size_t> hour_ahead(const std::vector<double>& t_s, double step_s) {
  constexpr double kLongestStep_s = 60.0;
  if (!(step_s > 0.0) || step_s > kLongestStep_s) return std::nullopt;
  std::optional<std::size_t> found;
  for (std::size_t i = 1; i < t_s.size(); ++i) {
    const double skipped_s = t_s[i] - t_s[i - 1] - kHour_s;
    if (skipped_s < 0.0 || skipped_s > 2.0 * step_s) continue;
    if (found || !is_when_clocks_are_set(t_s[i], 2.0 * step_s)) return std::nullopt;
    found = i;
  }
  return found;
}

std::string hint_for_hour_ahead() {
  return "an hour is what clocks go ahead at the beginning of summer time: take it off the stamps from there on, " + kZones + ", also where the recording did pause for it";
}

}  // namespace forcegate
