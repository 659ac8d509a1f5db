#pragma once
// Force from conductance and capacitance with an uncertainty (ours): each variable gives an estimate of the force by its own
// parabola; the two are joined by the best linear unbiased weights of their error covariance, which is learnt from the
// loadings that each parabola has not seen.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/impedance/network.h"

namespace forcegate::impedance {

/// Covariance of the two estimates' errors as S(F) = S_0 + S_1 (F/F_max)^2, each {conductance, both, capacitance}, N^2.
struct ErrorCovariance {
  std::array<double, 3> at_zero{}, at_full{};
  double loadings = 0;  ///< number of loadings that carry it
};

struct ForceEstimate {
  double force_N = 0;
  double u_N = 0;  ///< standard uncertainty of a reading in a new loading
};

class TwoVariableModel {
 public:
  ForceEstimate estimate(double output_V, double capacitance_F) const;
  /// Degrees of freedom of u_N, for coverage factors: those of the pooled covariance.
  double dof() const { return covariance_.loadings; }
  const ErrorCovariance& covariance() const { return covariance_; }

 private:
  friend Result<std::vector<TwoVariableModel>> fit_two_variable(
      const std::vector<std::vector<std::vector<ForceReading>>>& sensors, double pool);
  struct Parabola {
    double centre = 0, scale = 1;
    std::array<double, 3> a{};
    double force_N(double x) const {
      const double t = (x - centre) / scale;
      return a[0] + t * (a[1] + t * a[2]);
    }
  };
  static Parabola fit_parabola(const std::vector<ForceReading>& readings, bool capacitance);

  Parabola from_conductance_, from_capacitance_;
  ErrorCovariance covariance_;
  double full_N_ = 250.0;
};

/// sensors[s][loading] are the training readings of the sensors of one set, at least two loadings each. One loading at a
/// time is left out to see what a new loading does; a sensor's covariance is drawn towards the mean of all with the weight
/// of `pool` loadings, since two or three loadings alone do not carry one. Errors (parse): too few loadings or readings.
Result<std::vector<TwoVariableModel>> fit_two_variable(
    const std::vector<std::vector<std::vector<ForceReading>>>& sensors, double pool = 4.0);

}  // namespace forcegate::impedance
