#include "hil/trace/bursts.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/base/evenly_chosen.h"
#include "hil/base/quantile.h"

namespace forcegate {
namespace {

constexpr double kShort = 0.5;      // of the mean step
constexpr double kMostShort = 0.45;  // of the steps, as in packets of two
constexpr std::size_t kFewestBursts = 8;

bool most_steps_are_short(const std::vector<double>& t, double short_s) {
  constexpr std::size_t kMost = 4096;
  std::size_t n = 0, counted = 0;
  EvenlyChosen choice(t.size(), kMost);
  for (std::size_t i = 1; i < t.size(); ++i)
    if (choice.next()) ++counted, n += t[i] - t[i - 1] < short_s;
  return static_cast<double>(n) >= kMostShort * static_cast<double>(counted);
}

/// Half of the time passes in steps as long as this and longer: the pause between two bursts.
double pause_of(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  std::ranges::sort(steps, std::greater<>());
  double passed_s = 0.0;
  for (const double step : steps)
    if (passed_s += step; passed_s >= 0.5 * (t.back() - t.front())) return step;
  return 0.0;
}

/// First row of each burst, and the end.
std::vector<std::size_t> starts_of(const std::vector<double>& t) {
  const double least_s = 0.5 * pause_of(t);
  std::vector<std::size_t> out{0};
  for (std::size_t i = 1; i < t.size(); ++i)
    if (t[i] - t[i - 1] >= least_s) out.push_back(i);
  out.push_back(t.size());
  return out;
}

/// The time that one row stands for; 0 where the rows of a burst do not go with the time since the one before, as where a logger writes what changes.
double period_of(const std::vector<double>& t, const std::vector<std::size_t>& starts) {
  constexpr double kOff = 0.75, kMostOff = 0.1;  // of the usual interval; of the bursts
  std::vector<double> each_s, intervals_s;
  const auto rows = [&](std::size_t k) { return static_cast<double>(starts[k + 1] - starts[k]); };
  for (std::size_t k = 1; k + 1 < starts.size(); ++k) {
    intervals_s.push_back(t[starts[k + 1] - 1] - t[starts[k] - 1]);
    each_s.push_back(intervals_s.back() / rows(k));
  }
  const double period_s = median(std::move(each_s)), usual_s = median(std::vector<double>(intervals_s));
  std::size_t off = 0;
  for (std::size_t k = 0; k < intervals_s.size(); ++k) off += std::fabs(intervals_s[k] - period_s * rows(k + 1)) > kOff * usual_s;
  return static_cast<double>(off) <= kMostOff * static_cast<double>(intervals_s.size()) ? period_s : 0.0;
}

double step_within(const std::vector<double>& t, const std::vector<std::size_t>& starts) {
  double time_s = 0.0;
  std::size_t steps = 0;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    time_s += t[starts[k + 1] - 1] - t[starts[k]];
    steps += starts[k + 1] - starts[k] - 1;
  }
  return time_s / static_cast<double>(steps);
}

struct MeanMove {
  double sum = 0.0;
  std::size_t n = 0, moved = 0;
  void add(double from, double to) {
    if (!std::isfinite(from) || !std::isfinite(to)) return;
    sum += std::fabs(to - from);
    ++n;
    moved += to != from;
  }
  double mean() const { return n > 0 ? sum / static_cast<double>(n) : 0.0; }
};

bool is_monotone(const std::vector<double>& values) {
  return std::ranges::adjacent_find(values, [](double a, double b) { return !(b > a); }) == values.end() ||
         std::ranges::adjacent_find(values, [](double a, double b) { return !(b < a); }) == values.end();
}

/// Whether the values move between two bursts as between two rows, in the column that tells most; false where none does.
bool runs_on_between(const std::vector<std::size_t>& starts, const std::vector<std::size_t>& rows, const OtherColumns& columns) {
  constexpr double kTells = 1.5;  // a whole interval moves more than a row by this, or noise is all there is
  constexpr double kAsOneRow = 0.3;
  constexpr std::size_t kMovesInOneOf = 10;  // a thermometer whose last digit changes twice tells nothing
  double most = kTells;
  bool runs_on = false;
  for (const std::vector<double>* values : columns) {
    if (is_monotone(*values)) continue;
    const auto at = [&](std::size_t i) { return (*values)[rows.empty() ? i : rows[i]]; };
    MeanMove within, between, whole;
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
      for (std::size_t i = starts[k] + 1; i < starts[k + 1]; ++i) within.add(at(i - 1), at(i));
      if (k == 0) continue;
      between.add(at(starts[k] - 1), at(starts[k]));
      whole.add(at(starts[k - 1]), at(starts[k]));
    }
    const double one = within.mean(), all = whole.mean();
    if (kMovesInOneOf * whole.moved < whole.n || !(one > 0.0) || !(all >= most * one)) continue;
    most = all / one;
    runs_on = std::fabs(between.mean() - one) < kAsOneRow * (all - one);
  }
  return runs_on;
}

}  // namespace

std::optional<std::vector<double>> stamps_of_bursts(const std::vector<double>& stamps_s, const std::vector<std::size_t>& rows, const OtherColumns& columns,
                                                    double declared_rate_Hz) {
  constexpr double kAgrees = 1.25;
  if (stamps_s.size() < 2 * kFewestBursts) return std::nullopt;
  const double short_s = kShort * (stamps_s.back() - stamps_s.front()) / static_cast<double>(stamps_s.size() - 1);
  if (!most_steps_are_short(stamps_s, short_s)) return std::nullopt;
  const std::vector<std::size_t> starts = starts_of(stamps_s);
  if (starts.size() <= kFewestBursts) return std::nullopt;
  const double period_s = period_of(stamps_s, starts);
  if (!(period_s > 0.0)) return std::nullopt;
  const auto is_declared = [&](double step_s) { return declared_rate_Hz * step_s > 1.0 / kAgrees && declared_rate_Hz * step_s < kAgrees; };
  if (!is_declared(period_s) && (is_declared(step_within(stamps_s, starts)) || !runs_on_between(starts, rows, columns))) return std::nullopt;
  std::vector<double> out(stamps_s.size());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) std::fill(out.begin() + static_cast<std::ptrdiff_t>(starts[k]), out.begin() + static_cast<std::ptrdiff_t>(starts[k + 1]), stamps_s[starts[k + 1] - 1]);
  return out;
}

}  // namespace forcegate
