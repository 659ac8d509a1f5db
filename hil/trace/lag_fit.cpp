#include "hil/trace/lag_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/quantile.h"

namespace forcegate {

void LagFit::push(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    history_ = 0;
    return;
  }
  x_[0] = x_[1], x_[1] = x_[2], x_[2] = x;
  y_[0] = y_[1], y_[1] = y_[2], y_[2] = y;
  if (++history_ < 3) return;
  const double middle = x_[1], d = (x_[2] - x_[0]) / (2.0 * step_s_), value = y_[1];
  n_ += 1.0;
  sx_ += middle;
  sd_ += d;
  sy_ += value;
  sxx_ += middle * middle;
  sdd_ += d * d;
  sxd_ += middle * d;
  sxy_ += middle * value;
  sdy_ += d * value;
  syy_ += value * value;
}

void LagFit::finish(double& lag_s, double& u_lag_s) const {
  lag_s = u_lag_s = std::numeric_limits<double>::quiet_NaN();
  if (n_ < 100.0) return;
  const double vxx = sxx_ / n_ - sx_ * sx_ / (n_ * n_), vdd = sdd_ / n_ - sd_ * sd_ / (n_ * n_);
  const double vxd = sxd_ / n_ - sx_ * sd_ / (n_ * n_), vxy = sxy_ / n_ - sx_ * sy_ / (n_ * n_);
  const double vdy = sdy_ / n_ - sd_ * sy_ / (n_ * n_), vyy = syy_ / n_ - sy_ * sy_ / (n_ * n_);
  const double determinant = vxx * vdd - vxd * vxd;
  if (!(vxx > 0.01) || !(determinant > 1e-9 * vxx * vdd)) return;
  const double g = (vxy * vdd - vdy * vxd) / determinant;
  const double h = (vdy * vxx - vxy * vxd) / determinant;
  if (!(g > 0.05)) return;
  lag_s = -h / g;
  const double residual = std::max(0.0, vyy - g * vxy - h * vdy);
  const double independent = std::max(4.0, n_ * step_s_);
  u_lag_s = std::sqrt(residual / (independent * (vdd - vxd * vxd / vxx))) / g;
}

void LagSearch::push(double x, double y) {
  if (!std::isfinite(x) || !std::isfinite(y)) {
    filled_ = history_ = 0;
    sum_x_ = sum_y_ = 0.0;
    return;
  }
  sum_x_ += x, sum_y_ += y;
  if (++filled_ < kEach) return;
  x = sum_x_ / kEach, y = sum_y_ / kEach;
  sum_x_ = sum_y_ = 0.0;
  filled_ = 0;
  at_ = at_ == 0 ? kMost : at_ - 1;
  x_[at_] = x_[at_ + kMost + 1] = x;
  y_[at_] = y_[at_ + kMost + 1] = y;
  if (++history_ <= kMost) return;
  for (std::size_t k = 0; k <= kMost; ++k) {
    behind_[k] += x_[at_ + k] * y;
    ahead_[k] += y_[at_ + k] * x;
  }
  n_ += 1.0;
  sx_ += x, sy_ += y;
  sxx_ += x * x, syy_ += y * y;
  if (n_ >= kStretch) close();
}

void LagSearch::close() {
  constexpr double kTogether = 0.7, kBetter = 0.2, kAlike = 0.02;
  const double mx = sx_ / n_, my = sy_ / n_, vxx = sxx_ / n_ - mx * mx, vyy = syy_ / n_ - my * my, scale = std::sqrt(vxx * vyy);
  const auto together = [&](double sum) { return (sum / n_ - mx * my) / scale; };
  if (vxx > 0.01) {
    ++stretches_;
    double best = 0.0;
    if (vyy > 0.0)
      for (std::size_t k = 0; k <= kMost; ++k) best = std::max({best, together(behind_[k]), together(ahead_[k])});
    if (best >= kTogether && best >= together(behind_[0]) + kBetter)
      for (std::size_t k = 0; k <= kMost; ++k) {
        const double b = together(behind_[k]), a = together(ahead_[k]);
        if (std::max(a, b) < best - kAlike) continue;
        const auto& side = b >= a ? behind_ : ahead_;
        while (k < kMost && side[k + 1] > side[k]) ++k;
        lags_s_.push_back((b >= a ? 1.0 : -1.0) * static_cast<double>(k * kEach) * step_s_);
        break;
      }
  }
  behind_ = ahead_ = {};
  n_ = sx_ = sy_ = sxx_ = syy_ = 0.0;
}

double LagSearch::finish() const {
  return lags_s_.empty() || 2 * lags_s_.size() < stretches_ ? std::numeric_limits<double>::quiet_NaN() : median(lags_s_);
}

}  // namespace forcegate
