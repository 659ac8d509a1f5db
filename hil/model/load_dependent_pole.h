#pragma once
// A first-order lag whose time constant falls with the load:
//   y' = (F - y)(F + Fe)/(tau (Fm + Fe)),   Fe = unloaded * span,  Fm: mid force, at which the time constant is tau.
// Fe next to nothing: the film's own resistance R(F) ~ 1/F charges a capacitance, the pole stands still without a load. Fe as large as the span and
// larger: layers that seat sooner under load.

#include <algorithm>

#include "hil/model/effect.h"
#include "hil/model/fading_memory.h"
#include "hil/model/states.h"

namespace forcegate {

/// `unloaded` from which on the pole is a lag of the layers, below it one of the film's resistance.
inline constexpr double kUnloadedOfLayers = 0.6;

/// (1 - e^-h) / h. Below a quarter by Pade's quotient, 4e-6 off at most: the step stands in the innermost loop of all.
inline double quick_mean_of_decay(double h) { return h < 0.25 ? 1.0 / (1.0 + h * (0.5 + h / 12.0)) : mean_of_decay(h); }

/// Column 0: D (y - F). `factor(F)`: by what the time constant is longer than the law says, 1 at mid force.
template <class Factor>
void load_dependent_pole(const CampaignInput& c, const RecordInput& r, double tau_s, double unloaded, ColumnsRef out, const Factor& factor) {
  const double zero_N = c.no_load_N(), floor = unloaded * c.range_N, middle = c.lowest_N - zero_N + 0.5 * c.range_N + floor;
  const double per_Ns = 1.0 / (tau_s * middle);
  double y = r.fast_F_N[0];
  const auto time_constants = [&](std::uint32_t k) {
    const double F = r.fast_F_N[k - 1];  // the firmware that undoes it must know before it has the force
    return (std::max(F - zero_N, 0.0) + floor) * per_Ns / factor(F) * (r.fast_t_s[k] - r.fast_t_s[k - 1]);
  };
  filter_wanted_rows(
      r,
      [&](std::uint32_t next, std::uint32_t k) {
        for (double h = 0.0; k > next && h < kForgotten; --k) h += time_constants(k);
        return k;
      },
      [&](std::uint32_t k) { return y = r.fast_F_N[k]; },
      // exact for a force that is linear between samples: held at their middle, a pole far shorter than a sample would be half a sample late
      [&](std::uint32_t k) {
        const double h = time_constants(k), mean = quick_mean_of_decay(h), before = r.fast_F_N[k - 1], now = r.fast_F_N[k];
        return y += h * mean * (before - y) + (1.0 - mean) * (now - before);
      },
      [&](std::size_t i, double mean) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (mean - r.F_N[i]); });
}

}  // namespace forcegate
