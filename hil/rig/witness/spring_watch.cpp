#include "hil/rig/witness/spring_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {
namespace {
constexpr double kLeastOfBlock = 10.0;  // groups
}  // namespace

SpringWatch::SpringWatch(const RigInfo& info)
    : geometry_(info.geometry), last_code_(last_code(info)), reference_lag_(GroupMeans::kGroup * (1.0 / info.rate_Hz)), sensor_lag_(reference_lag_) {}

void SpringWatch::close_block() {
  if (block_n_ >= kLeastOfBlock && std::fabs(block_bias_ / block_n_) > std::fabs(worst_bias_N_)) worst_bias_N_ = block_bias_ / block_n_;
  block_n_ = block_bias_ = 0.0;
}

void SpringWatch::push(std::span<const GroupMean> groups) {
  if (!(geometry_.eccentricity_mm > 0.0)) return;
  for (const GroupMean& g : groups) {
    if (g.begins_block) close_block();
    block_n_ += 1.0;
    if (!std::isfinite(g.theta_rad)) continue;
    const double spring_N = spring_force_N(geometry_, g.theta_rad);
    ++n_;
    sx_ += spring_N;
    sy_ += g.force_N;
    sxx_ += spring_N * spring_N;
    sxy_ += spring_N * g.force_N;
    syy_ += g.force_N * g.force_N;
    block_bias_ += g.force_N - spring_N;
    reference_lag_.push(spring_N, g.force_N);
    sensor_lag_.push(g.force_N, 10.0 * g.code / last_code_);
  }
}

void SpringWatch::finish(RigObservation& o) const {
  o.spring_samples = n_;
  if (n_ < kLeastSamples) {
    o.spring_bias_N = o.spring_rms_N = o.spring_worst_bias_N = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  SpringWatch end = *this;
  end.close_block();
  o.spring_worst_bias_N = end.worst_bias_N_;
  const double n = static_cast<double>(n_);
  const double vx = sxx_ / n - (sx_ / n) * (sx_ / n);
  const double cxy = sxy_ / n - (sx_ / n) * (sy_ / n);
  const double vy = syy_ / n - (sy_ / n) * (sy_ / n);
  o.spring_bias_N = (sy_ - sx_) / n;
  o.spring_rms_N = std::sqrt(std::max(0.0, vy - 2.0 * cxy + vx));
  if (vx > 0.01) o.spring_slope = cxy / vx;
  double unused = 0.0;
  reference_lag_.finish(o.reference_lag_s, unused);
  sensor_lag_.finish(o.sensor_lag_s, unused);
}

}  // namespace forcegate::witness
