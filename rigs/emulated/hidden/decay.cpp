#include "rigs/emulated/hidden/decay.h"

#include <algorithm>
#include <cmath>

#include "hil/base/portable_math.h"

namespace forcegate::hidden {
namespace {

constexpr double kRewind_s = 40.0;  // time constant of recovery while the film is unloaded in the air

struct Law {
  double b_per_s = 0.0, q = 1.0, initial_gain = 1.0;
};

Law parameters(DecayLaw kind, const RecordContext& context) {
  const double f = context.plan.f_min_Hz, A = context.plan.amplitude_N();
  Law law;
  law.b_per_s = 0.0019 * f + 0.0056;
  law.q = 1.0 / (1.0 + 1.377 * A * A);
  if (kind == DecayLaw::root_f) law.b_per_s = 0.0040 + 0.0033 * std::sqrt(f);
  if (kind == DecayLaw::exponential_A) law.q = 0.96 * portable::exp(-0.80 * A);
  if (kind == DecayLaw::absolute) {
    const double a_V = 0.884 * A * A + 0.865 * A;
    const double paper_N_per_V =
        context.truth.gain_N_per_V * context.voltage_range_V / 10.0;  // the paper's range is 10 V
    law.initial_gain = a_V * (1.0 + law.q) * paper_N_per_V / (2.0 * A);
  }
  law.b_per_s *= context.truth.b_scale;
  law.q *= context.truth.q_scale;
  return law;
}

/// What the film feels while the load is at its lowest: the minima are what stays (Lebosse 2011, section III-C), whatever lies between load and film.
double film_low_N(const Waves& waves, const RecordContext& context) {
  const double band = 0.01 * (context.plan.high_N - context.plan.low_N);
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < waves.size(); ++i)
    if (std::abs(waves.force_N[i] - context.plan.low_N) <= band) {
      sum += waves.film_N[i] - waves.force_N[i];
      n += 1.0;
    }
  return context.plan.low_N + (n > 0.0 ? sum / n : 0.0);
}

/// The state-driven law: rate from the running loading rate, floor from a leaky running minimum.
void apply_state_driven(const Law& law, Waves& waves, const RecordContext& context) {
  const double h = waves.step_s, G = context.truth.gain_N_per_V, F0 = context.truth.offset_N;
  const double period_s = context.plan.f_min_Hz > 0.0 ? 1.0 / context.plan.f_min_Hz : 10.0;
  const double memory = std::min(1.0, h / (3.0 * period_s)), leak = std::min(1.0, h / (60.0 * period_s));
  const double span = 2.0 * context.plan.amplitude_N();
  const double low_N = film_low_N(waves, context);
  double x = 1.0, floor_N = low_N, rate = context.plan.f_min_Hz, before = waves.film_N.front();
  const double base = 0.0056 * context.truth.b_scale, slope = 0.0019 * context.truth.b_scale;
  const auto start = static_cast<std::size_t>(context.plan.excitation_start_s / h);
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double F = waves.film_N[i];
    if (i >= start) {
      rate += memory * (std::abs(F - before) / h / (2.0 * span) - rate);
      const double shaken = rate / (rate + 0.004);
      x -= h * (base + slope * std::min(rate, 6.0)) * shaken * x;
      if (!waves.airborne.empty() && waves.airborne[i]) x += h / kRewind_s * (1.0 - x);
      floor_N = F < floor_N ? F : floor_N + leak * (low_N - floor_N);
    }
    before = F;
    const double D = (x + law.q) / (1.0 + law.q);
    const double W = F <= floor_N ? F : floor_N + D * (F - floor_N);
    waves.voltage_V[i] = (W - F0) / G;
  }
}

}  // namespace

std::string_view to_string(DecayLaw law) {
  switch (law) {
    case DecayLaw::ratio: return "ratio";
    case DecayLaw::root_f: return "root_f";
    case DecayLaw::exponential_A: return "exponential_A";
    case DecayLaw::state_driven: return "state_driven";
    case DecayLaw::absolute: return "absolute";
  }
  return "?";
}

void apply_decay(DecayLaw kind, Waves& waves, const RecordContext& context) {
  const std::size_t n = waves.size();
  waves.voltage_V.resize(n);
  const double per_G = 1.0 / context.truth.gain_N_per_V, F0 = context.truth.offset_N;
  if (!context.plan.dynamic) {
    for (std::size_t i = 0; i < n; ++i) waves.voltage_V[i] = (waves.film_N[i] - F0) * per_G;
    return;
  }
  const Law law = parameters(kind, context);
  if (kind == DecayLaw::state_driven) return apply_state_driven(law, waves, context);
  const double h = waves.step_s, floor_N = film_low_N(waves, context);
  const auto start = static_cast<std::size_t>(context.plan.excitation_start_s / h);
  const double keep = portable::exp(-law.b_per_s * h), per_q = 1.0 / (1.0 + law.q);
  double x = 1.0;
  for (std::size_t i = 0; i < n; ++i) {
    double D = 1.0;
    if (i >= start) {
      D = law.initial_gain * (x + law.q) * per_q;
      x *= keep;
      if (!waves.airborne.empty() && waves.airborne[i]) x += h / kRewind_s * (1.0 - x);
    }
    const double F = waves.film_N[i];
    const double W = F <= floor_N ? F : floor_N + D * (F - floor_N);
    waves.voltage_V[i] = (W - F0) * per_G;
  }
}

}  // namespace forcegate::hidden
