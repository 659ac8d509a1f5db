#include "rigs/emulated/hidden/profile.h"

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "rigs/emulated/hidden/numeric.h"

namespace forcegate::hidden {
namespace {

constexpr double kTwoPi = 2.0 * kPi;

void fill_ramp(const RecordPlan& plan, double t0, Waves& waves) {
  const double period_s = (plan.duration_s - t0 - 3.0) / plan.repeats;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double t = static_cast<double>(i) * waves.step_s - t0;
    if (t < 0.0 || t >= period_s * plan.repeats) continue;
    const double phase = t / period_s - std::floor(t / period_s);
    const double rise = phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
    waves.setpoint_N[i] = plan.low_N + (plan.high_N - plan.low_N) * rise;
  }
}

/// Moves between levels at a finite slew, as a servo does.
void fill_levels(const RecordPlan& plan, double t0, const std::vector<double>& levels_N, double slew_N_per_s,
                 Waves& waves) {
  double now_N = plan.low_N;
  const double step_N = slew_N_per_s * waves.step_s;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double t = static_cast<double>(i) * waves.step_s - t0;
    double target = plan.low_N;
    if (t >= 0.0 && !levels_N.empty())
      target = levels_N[std::min(levels_N.size() - 1, static_cast<std::size_t>(t / plan.dwell_s))];
    now_N += std::clamp(target - now_N, -step_N, step_N);
    waves.setpoint_N[i] = now_N;
  }
}

void fill_sines(const RecordPlan& plan, double t0, Waves& waves) {
  double total = 0.0;
  for (const double w : plan.weights) total += w;
  const double m = plan.mean_N(), A = plan.amplitude_N();
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double t = static_cast<double>(i) * waves.step_s - t0;
    if (t < 0.0) continue;
    double sum = 0.0;
    for (std::size_t k = 0; k < plan.weights.size(); ++k)
      sum += plan.weights[k] / total * portable::cos(kTwoPi * plan.frequencies_Hz[k] * t);
    waves.setpoint_N[i] = m - A * sum;
  }
}

/// Frequency as a function of time with continuous phase: sweep (linear) and switch (piecewise constant).
template <class Frequency>
void fill_phase(const RecordPlan& plan, double t0, Waves& waves, Frequency frequency_Hz) {
  const double m = plan.mean_N(), A = plan.amplitude_N();
  double turns = 0.0;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double t = static_cast<double>(i) * waves.step_s;
    if (t < t0) continue;
    waves.setpoint_N[i] = m - A * portable::cos(kTwoPi * (turns - std::floor(turns)));
    turns += frequency_Hz(t) * waves.step_s;
  }
}

/// Straight lines between the points.
void fill_points(const RecordPlan& plan, Waves& waves) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double t = static_cast<double>(i) * waves.step_s;
    while (k + 2 < plan.point_s.size() && plan.point_s[k + 1] <= t) ++k;
    const double span_s = plan.point_s[k + 1] - plan.point_s[k];
    const double share = span_s > 0.0 ? std::clamp((t - plan.point_s[k]) / span_s, 0.0, 1.0) : 1.0;
    waves.setpoint_N[i] = plan.point_N[k] + share * (plan.point_N[k + 1] - plan.point_N[k]);
  }
}

std::vector<double> levels_of(const RecordPlan& plan) {
  std::vector<double> levels;
  const double span = plan.high_N - plan.low_N;
  if (plan.kind == "hold") return {plan.high_N, plan.low_N};
  if (plan.kind == "staircase") {
    for (int k = 1; k <= plan.repeats; ++k) levels.push_back(plan.low_N + span * k / plan.repeats);
    for (int k = plan.repeats - 1; k >= 1; --k) levels.push_back(plan.low_N + span * k / plan.repeats);
    return levels;
  }
  Rng rng(plan.seed, "levels");
  const auto count = static_cast<std::size_t>(plan.duration_s / plan.dwell_s) + 1;
  for (std::size_t k = 0; k < count; ++k) {
    if (plan.kind == "prbs")
      levels.push_back(rng.uniform() < 0.5 ? plan.low_N : plan.high_N);
    else
      levels.push_back(k % 3 == 2 ? plan.low_N : plan.low_N + span * rng.uniform(0.25, 1.0));
  }
  return levels;
}

}  // namespace

void fill_setpoint(const RecordPlan& plan, Waves& waves) {
  const double t0 = plan.excitation_start_s;
  std::fill(waves.setpoint_N.begin(), waves.setpoint_N.end(), plan.low_N);
  if (plan.point_s.size() > 1) return fill_points(plan, waves);
  if (plan.kind == "ramp") return fill_ramp(plan, t0, waves);
  if (plan.kind == "sine" || plan.kind == "multisine") return fill_sines(plan, t0, waves);
  if (plan.kind == "sweep") {
    const double f0 = plan.frequencies_Hz.front(), f1 = plan.frequencies_Hz.back();
    const double rate = (f1 - f0) / (plan.duration_s - t0);
    return fill_phase(plan, t0, waves, [=](double t) { return f0 + rate * (t - t0); });
  }
  if (plan.kind == "switch")
    return fill_phase(plan, t0, waves, [&](double t) {
      std::size_t k = 0;
      while (k < plan.event_s.size() && t >= plan.event_s[k]) ++k;
      return plan.frequencies_Hz[std::min(k, plan.frequencies_Hz.size() - 1)];
    });
  if (plan.kind == "rest") return;
  RecordPlan moving = plan;
  if (plan.kind == "hold") moving.dwell_s = 0.8 * (plan.duration_s - t0);
  const double slew_N_per_s = plan.kind == "prbs" || plan.kind == "steps" ? 60.0 : 2.0;
  fill_levels(moving, t0, levels_of(plan), slew_N_per_s, waves);
}

}  // namespace forcegate::hidden
