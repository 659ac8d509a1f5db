#pragma once
// Small state machines that effects are made of.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate {

/// (1 - e^-h) / h for h >= 0 to the last bit or two: a series below 1/8, brought there by quarters of h.
inline double mean_of_decay(double h) {
  if (h > 8.0) return (1.0 - std::exp(-h)) / h;
  int quarters = 0;
  for (; h > 0.125; ++quarters) h *= 0.25;
  const double tail = 1.0 / 720.0 - h * (1.0 / 5040.0 - h * (1.0 / 40320.0 - h * (1.0 / 362880.0 - h / 3628800.0)));
  double mean =
      1.0 - h * (1.0 / 2.0 - h * (1.0 / 6.0 - h * (1.0 / 24.0 - h * (1.0 / 120.0 - h * tail))));
  for (; quarters > 0; --quarters, h *= 4.0) {
    const double keep = 1.0 - h * mean;
    mean *= 0.25 * (1.0 + keep) * (1.0 + keep * keep);
  }
  return mean;
}

/// tau y' + y = x with x linear between samples (exact for that input, any step).
class LowPass {
 public:
  LowPass(double tau_s, double state) : tau_s_(tau_s), state_(state) {}
  double step(double x_before, double x, double dt_s) {
    const Weights& w = weights(dt_s);
    state_ = w.keep * state_ + (w.to_old * x_before + w.to_new * x);
    return state_;
  }
  void settle(double x) { state_ = x; }
  double state() const { return state_; }

 private:
  struct Weights {
    double dt_s = -1.0, keep = 0.0, to_old = 0.0,
           to_new = 1.0;  ///< to_old, to_new: the two ends of the linear piece
  };

  /// A nominally uniform clock has a handful of steps that differ in their last bits: they are kept, not recomputed.
  const Weights& weights(double dt_s) {
    Weights& w = cache_[(std::bit_cast<std::uint64_t>(dt_s) * 0x9e3779b97f4a7c15ull) >> 58];
    if (dt_s != w.dt_s) {
      const double h = dt_s / tau_s_, mean = mean_of_decay(h), keep = 1.0 - h * mean;
      w = {dt_s, keep, mean - keep, 1.0 - mean};
    }
    return w;
  }

  double tau_s_, state_;
  std::array<Weights, 64> cache_{};
};

/// Of itself: a state that is nearer to what it follows has settled. In a hold the last bits of a float must not tell which way it goes.
inline constexpr double kSettled = 1e-5;

/// log(1 + e^(x/w)) w without overflow: a hinge with a rounded corner of width w.
inline double soft_hinge(double x, double w) {
  const double z = x / w;
  if (z > 30.0) return x;
  if (z < -30.0) return 0.0;
  return w * std::log1p(std::exp(z));
}

/// Low pass of the full-rate force, which starts settled, averaged over each wanted row; 0 in the others.
std::vector<double> low_pass_rows(const RecordInput& record, double tau_s, int poles = 1);

/// h(L[F]), or L[h(F)], of the full-rate force, averaged over each wanted row, 0 in the others; L one pole of tau_s that starts settled.
enum class LagAndCurve { curve_of_lagged, lag_of_curve };
std::vector<double> lagged_curve_rows(const RecordInput& record, double tau_s, LagAndCurve order, const std::function<double(double)>& h);

/// F(t - delay_s), linear between full-rate samples, averaged over each wanted row; 0 in the others.
std::vector<double> delayed_rows(const RecordInput& record, double delay_s, double skew = 0.0);
/// The same, by block_s for each of the record's lost blocks.
std::vector<double> rows_behind_lost_blocks(const RecordInput& record, double block_s);

/// Low pass of a row channel.
std::vector<double> low_pass_channel(const RecordInput& record, std::span<const double> x, double tau_s,
                                     double first_state);

/// Low passes of the same channel at several constants, summed with weights: a relaxation spectrum.
std::vector<double> spectrum_response(const RecordInput& record, std::span<const double> x,
                                      std::span<const double> tau_s, std::span<const double> weight,
                                      double first_state);

/// Spread (logistic) of the forces at which contacts close, over their middle.
inline constexpr double kThresholdSpread = 0.25;

/// Where a static curve h stands to the decay of cyclic records.
enum class CurveAt {
  force,    ///< the film feels F + h(F), lowest force and all: h(F_min) + D (h(F) - h(F_min))
  swing,    ///< the film's lowest force is that of the load: D h(F)
  decayed,  ///< acts on the decayed base force W: h(W)
};

template <class Curve>
void add_curve(const RecordInput& record, CurveAt at, const Curve& h, Eigen::Ref<Eigen::VectorXd> out) {
  const double low = at == CurveAt::force && record.dynamic ? h(record.F_min_N) : 0.0;
  record.for_each_wanted([&](std::size_t i) {
    const double D = record.dynamic ? record.decay[i] : 1.0;
    out[static_cast<Eigen::Index>(i)] = at == CurveAt::decayed ? h(record.base_force_N(i)) : low + D * (h(record.F_N[i]) - low);
  });
}

}  // namespace forcegate
