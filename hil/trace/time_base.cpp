#include "hil/trace/time_base.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/text.h"

namespace forcegate {
namespace {

double median_step(const std::vector<double>& t) {
  const std::size_t n = t.size() - 1, stride = std::max<std::size_t>(1, n / 4096);
  std::vector<double> steps;
  for (std::size_t i = 0; i < n; i += stride) steps.push_back(t[i + 1] - t[i]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

/// Steps above 1.5 nominal ones, allowing for the rounding of the stamps.
std::size_t count_gaps(const std::vector<double>& t, double step) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < t.size(); ++i) n += t[i] - t[i - 1] > 1.5 * step * (1 + 1e-9);
  return n;
}

void find_rate_and_gaps(TimeBase& base) {
  const auto& t = base.t_s;
  if (t.size() < 2) return;
  double step = median_step(t);
  const auto steps = static_cast<double>(t.size() - 1);
  if (static_cast<double>(count_gaps(t, step)) > 0.1 * steps) step = (t.back() - t.front()) / steps;
  if (!(step > 0.0) || static_cast<double>(count_gaps(t, step)) > 0.1 * steps) return;
  double missing_s = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (t[i] - t[i - 1] > 1.5 * step * (1 + 1e-9)) {
      base.gaps.push_back({i, t[i - 1], t[i]});
      missing_s += t[i] - t[i - 1];
    }
  const double regular = steps - static_cast<double>(base.gaps.size());
  base.nominal_rate_Hz = regular > 0 ? regular / (t.back() - t.front() - missing_s) : 1.0 / step;
}

std::string times(std::size_t n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

bool misses_stamp(const std::vector<double>& stamps_s, std::size_t behind, std::size_t before) {
  for (std::size_t i = behind + 1; i < before; ++i)
    if (!std::isfinite(stamps_s[i])) return true;
  return false;
}

std::string without_stamp(const std::vector<double>& stamps_s, const LineOfRow& line_of_row) {
  constexpr std::size_t kNamed = 3;
  std::size_t n = 0;
  std::string lines;
  for (std::size_t i = 0; i < stamps_s.size(); ++i)
    if (!std::isfinite(stamps_s[i]) && n++ < kNamed) lines += (n == 1 ? "" : ", ") + std::to_string(line_of_row(i));
  const std::string more = n > kNamed ? " and " + std::to_string(n - kNamed) + " more" : "";
  return times(n, "row has", "rows have") + " no time stamp (line" + (n == 1 ? " " : "s ") + lines + more + "); dropped";
}

// A clock of day begins anew at midnight: stamps within one day that fall from its end to its beginning. Days that were added.
std::size_t unwrap_midnights(std::vector<double>& stamps_s) {
  constexpr double kDay_s = 86400.0, kNear_s = 60.0;
  for (const double t : stamps_s)
    if (std::isfinite(t) && !(t >= 0.0 && t <= kDay_s)) return 0;
  double added_s = 0.0, before = kMissing;
  for (double& t : stamps_s) {
    if (!std::isfinite(t)) continue;
    if (before > kDay_s - kNear_s && t < kNear_s) added_s += kDay_s;
    before = t;
    t += added_s;
  }
  return static_cast<std::size_t>(added_s / kDay_s);
}

}  // namespace

TimeBase with_rate_and_gaps(std::vector<double> t_s) {
  TimeBase base;
  base.t_s = std::move(t_s);
  find_rate_and_gaps(base);
  return base;
}

TimeBase invented_clock(std::size_t rows, double rate_Hz) {
  TimeBase base;
  base.invented = true;
  base.nominal_rate_Hz = rate_Hz;
  base.t_s.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) base.t_s[i] = static_cast<double>(i) / rate_Hz;
  return base;
}

Result<Clock> make_clock(std::vector<double> stamps_s, const std::string& where, const LineOfRow& line_of_row) {
  Clock clock;
  if (const std::size_t days = unwrap_midnights(stamps_s); days > 0)
    clock.notes.push_back("the clock of day passes midnight" + (days == 1 ? std::string() : " " + std::to_string(days) + " times") + "; counted on");
  bool increasing = !stamps_s.empty() && std::isfinite(stamps_s.front());
  for (std::size_t i = 1; i < stamps_s.size() && increasing; ++i)
    increasing = stamps_s[i] > stamps_s[i - 1] && stamps_s[i] < HUGE_VAL;
  if (!increasing) {
    auto& rows = clock.rows;
    for (std::size_t i = 0; i < stamps_s.size(); ++i)
      if (std::isfinite(stamps_s[i])) rows.push_back(i);
    if (rows.empty())
      return fail(ErrorCode::parse, "no row has a time stamp", where,
                  "map another column, --map NAME=t_s, or leave the clock out: --map CLOCK=unused --rate HZ");
    if (rows.size() < stamps_s.size())
      clock.notes.push_back(without_stamp(stamps_s, line_of_row));

    std::vector<double> t;
    for (const std::size_t r : rows) t.push_back(stamps_s[r]);
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(std::fabs(t[i] - t[i - 1]));
    double step = 0.0;
    if (!steps.empty()) {
      const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
      std::nth_element(steps.begin(), middle, steps.end());
      step = *middle;
    }
    std::size_t backwards = 0;
    double latest = t.front();
    for (std::size_t i = 1; i < t.size(); ++i) {
      if (t[i] < latest) {
        ++backwards;
        if (latest - t[i] > 10.0 * step)
          return fail(ErrorCode::parse,
                      "the clock jumps back from " + shortest(latest) + " s to " + shortest(t[i]) +
                          " s in line " + std::to_string(line_of_row(rows[i])),
                      where, "split the file where a new recording begins");
      }
      latest = std::max(latest, t[i]);
    }
    if (backwards > 0) {
      std::stable_sort(rows.begin(), rows.end(),
                       [&](std::size_t a, std::size_t b) { return stamps_s[a] < stamps_s[b]; });
      clock.notes.push_back(times(backwards, "row was", "rows were") + " out of order; sorted by time");
    }
    const std::size_t before = rows.size();
    rows.erase(std::unique(rows.begin(), rows.end(),
                           [&](std::size_t a, std::size_t b) { return stamps_s[a] == stamps_s[b]; }),
               rows.end());
    const std::size_t repeated = before - rows.size();
    if (repeated > 1 && repeated * 100 > before)
      return fail(
          ErrorCode::parse,
          "the clock stands still in " + std::to_string(repeated) + " of " + std::to_string(before) + " rows",
          where,
          "its resolution is coarser than the sample rate; leave it out: --map CLOCK=unused --rate HZ");
    if (repeated > 0)
      clock.notes.push_back(times(repeated, "row repeats", "rows repeat") + " a time stamp; dropped");
    clock.base.t_s.reserve(rows.size());
    for (const std::size_t r : rows) clock.base.t_s.push_back(stamps_s[r]);
  } else {
    clock.base.t_s = std::move(stamps_s);
  }

  find_rate_and_gaps(clock.base);
  std::size_t gaps = 0;
  double longest = 0.0;
  for (const Gap& g : clock.base.gaps) {
    if (!clock.rows.empty() && misses_stamp(stamps_s, clock.rows[g.index - 1], clock.rows[g.index])) continue;  // is told already
    ++gaps;
    longest = std::max(longest, g.to_s - g.from_s);
  }
  if (gaps > 0) {
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.4g", longest);
    clock.notes.push_back(times(gaps, "gap", "gaps") + " in the clock, the longest " + shown + " s");
  }
  if (clock.base.nominal_rate_Hz == 0.0 && clock.base.t_s.size() > 2)
    clock.notes.push_back("the clock is not uniform: there is no one sample rate");
  return clock;
}

}  // namespace forcegate
