#include "hil/trace/lag_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

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

}  // namespace forcegate
