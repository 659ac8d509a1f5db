#pragma once
// The static law F = G U + F0 (Lebosse 2011, eq. 1) by least squares, from sums: nothing is kept of the samples.

#include <cmath>
#include <cstddef>

namespace forcegate {

class StaticLine {
 public:
  void push(double sensor_V, double force_N) {
    n_ += 1, su_ += sensor_V, sf_ += force_N;
    suu_ += sensor_V * sensor_V, suf_ += sensor_V * force_N, sff_ += force_N * force_N;
  }

  double n() const { return n_; }
  double mean_V() const { return su_ / n_; }
  double mean_N() const { return sf_ / n_; }
  /// Variance of U, V^2, and of F, N^2; covariance, V N. All with 1/n.
  double variance_V2() const { return suu_ / n_ - su_ * su_ / (n_ * n_); }
  double variance_N2() const { return sff_ / n_ - sf_ * sf_ / (n_ * n_); }
  double covariance_VN() const { return suf_ / n_ - su_ * sf_ / (n_ * n_); }
  /// Whether U varies by more than `least_V2` and F rises with it; false without samples.
  bool answers(double least_V2) const { return variance_V2() > least_V2 && covariance_VN() > 0.0; }

  double gain_N_per_V() const { return covariance_VN() / variance_V2(); }
  double offset_N() const { return sf_ / n_ - gain_N_per_V() * su_ / n_; }
  /// Root mean square of F - (G U + F0), N.
  double residual_N() const {
    const double left = variance_N2() - covariance_VN() * covariance_VN() / variance_V2();
    return std::sqrt(left > 0.0 ? left : 0.0);
  }

 private:
  double n_ = 0, su_ = 0, sf_ = 0, suu_ = 0, suf_ = 0, sff_ = 0;
};

/// Means of `group` pairs after each other, so that noise of single samples does not tilt the line.
class PairMeans {
 public:
  explicit PairMeans(std::size_t group) : group_(group) {}
  /// True when a group is full; its means stand until the next one is.
  bool push(double sensor_V, double force_N) {
    u_sum_ += sensor_V;
    f_sum_ += force_N;
    if (++filled_ < group_) return false;
    u_V_ = u_sum_ / static_cast<double>(group_);
    f_N_ = f_sum_ / static_cast<double>(group_);
    filled_ = 0;
    u_sum_ = f_sum_ = 0.0;
    return true;
  }
  double sensor_V() const { return u_V_; }
  double force_N() const { return f_N_; }

 private:
  std::size_t group_, filled_ = 0;
  double u_sum_ = 0.0, f_sum_ = 0.0, u_V_ = 0.0, f_N_ = 0.0;
};

}  // namespace forcegate
