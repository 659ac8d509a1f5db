#include "hil/trace/time_base.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hil/base/evenly_chosen.h"
#include "hil/base/quantile.h"

namespace forcegate {
namespace {

double median_step(const std::vector<double>& t) {
  EvenlyChosen choice(t.size() - 1, 4096);
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (choice.next()) steps.push_back(t[i] - t[i - 1]);
  return median(std::move(steps));
}

constexpr double kGap = 1.5;  // nominal steps, with room for the rounding of the stamps
bool is_long(double step_s, double nominal_s) { return step_s > kGap * nominal_s * (1 + 1e-9); }

std::size_t count_long(const std::vector<double>& t, double step) {
  std::size_t n = 0;
  for (std::size_t i = 1; i < t.size(); ++i) n += is_long(t[i] - t[i - 1], step);
  return n;
}

// A uniform clock with rounded stamps has steps of two lengths.
bool is_rounded(const std::vector<double>& t, double step) {
  constexpr double kSame = 1e-3;
  std::vector<double> lengths;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double length = t[i] - t[i - 1];
    if (is_long(length, step) || std::ranges::any_of(lengths, [&](double known) { return std::fabs(known - length) < kSame * step; })) continue;
    if (lengths.size() == 2) return false;
    lengths.push_back(length);
  }
  return true;
}

// Standard deviation of the stamps about a uniform clock, in steps, from their second differences: a rate that changes is no jitter.
double jitter_of(const std::vector<double>& t, double step) {
  constexpr std::size_t kMost = 8192;
  if (t.size() < 3 || is_rounded(t, step)) return 0.0;
  std::vector<double> second;
  EvenlyChosen choice(t.size(), kMost);
  for (std::size_t i = 1; i + 1 < t.size(); ++i)
    if (choice.next()) second.push_back(std::fabs(t[i + 1] - 2.0 * t[i] + t[i - 1]));
  return deviation_of_magnitudes(std::move(second)) / std::sqrt(6.0) / step;
}

/// The jitter, in steps.
double find_rate_and_gaps(TimeBase& base) {
  constexpr double kMostJitter = 0.25, kStandsOut = 5.0;  // beyond there is no rate; standard deviations of a step
  const auto& t = base.t_s;
  if (t.size() < 2) return 0.0;
  double step = median_step(t);
  const auto steps = static_cast<double>(t.size() - 1);
  if (static_cast<double>(count_long(t, step)) > 0.1 * steps) step = (t.back() - t.front()) / steps;
  if (!(step > 0.0)) return 0.0;
  const double jitter = jitter_of(t, step);
  const bool jitters = jitter > 0.0 && jitter <= kMostJitter;
  if (!jitters && static_cast<double>(count_long(t, step)) > 0.1 * steps) return 0.0;
  const double least = jitters ? 1.0 + kStandsOut * std::sqrt(2.0) * jitter : 0.0;
  // nothing is missing where a neighbour is as much shorter: that stamp came late
  const auto made_up_for = [&](std::size_t i) {
    const double before = i > 1 ? t[i - 1] - t[i - 2] : HUGE_VAL, behind = i + 1 < t.size() ? t[i + 1] - t[i] : HUGE_VAL;
    return t[i] - t[i - 1] + std::min(before, behind) < (1.0 + kGap) * step;
  };
  double missing_s = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i)
    if (is_long(t[i] - t[i - 1], step) && t[i] - t[i - 1] > least * step && !made_up_for(i)) {
      base.gaps.push_back({i, t[i - 1], t[i]});
      missing_s += t[i] - t[i - 1];
    }
  const double regular = steps - static_cast<double>(base.gaps.size());
  base.nominal_rate_Hz = regular > 0 ? regular / (t.back() - t.front() - missing_s) : 1.0 / step;
  return jitters ? jitter : 0.0;
}

bool misses_stamp(const std::vector<double>& stamps_s, std::size_t behind, std::size_t before) {
  for (std::size_t i = behind + 1; i < before; ++i)
    if (!std::isfinite(stamps_s[i])) return true;
  return false;
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

Result<Clock> make_clock(std::vector<double> stamps_s, const ClockSource& source) {
  constexpr double kToldJitter = 0.05;
  FORCEGATE_TRY(OrderedStamps ordered, order_stamps(stamps_s, source));
  Clock clock{.base = {}, .rows = std::move(ordered.rows), .notes = std::move(ordered.notes)};
  clock.base.t_s = std::move(ordered.t_s);
  if (const double jitter = find_rate_and_gaps(clock.base); jitter >= kToldJitter)
    clock.notes.push_back("the clock jitters by " + std::to_string(std::lround(100.0 * jitter)) + " % of a period");
  std::size_t gaps = 0;
  double longest_s = 0.0;
  for (const Gap& g : clock.base.gaps) {
    if (!clock.rows.empty() && misses_stamp(stamps_s, clock.rows[g.index - 1], clock.rows[g.index])) continue;  // is told already
    ++gaps;
    longest_s = std::max(longest_s, g.to_s - g.from_s);
  }
  if (gaps > 0) clock.notes.push_back(fmt::format("{} gap{} in the clock, the longest {:.4g} s", gaps, gaps == 1 ? "" : "s", longest_s));
  if (clock.base.nominal_rate_Hz == 0.0 && clock.base.t_s.size() > 2)
    clock.notes.push_back("the clock is not uniform: there is no one sample rate");
  return clock;
}

}  // namespace forcegate
