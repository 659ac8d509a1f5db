#pragma once
// The one-variable force models of Paredes-Madrid 2010, VI, and the errors by which models are compared.

#include <functional>
#include <span>

#include "hil/model/impedance/network.h"

namespace forcegate::impedance {

/// F = slope x + offset by least squares of the force on x.
struct LineModel {
  double slope = 0, offset_N = 0;
  double force_N(double x) const { return slope * x + offset_N; }
};

/// First model: x = V_o. Second model: x = C_s. At least two different x.
LineModel fit_conductance(std::span<const ForceReading> readings);
LineModel fit_capacitance(std::span<const ForceReading> readings);

using ForceModel = std::function<double(const ForceReading&)>;  ///< sees output_V and capacitance_F only

/// Mean squared error, N^2.
double mean_squared_error_N2(std::span<const ForceReading> readings, const ForceModel& model);

/// Eq. (11), percent.
inline double error_reduction_pct(double network_N2, double conductance_N2) {
  return 100.0 * (1.0 - network_N2 / conductance_N2);
}

}  // namespace forcegate::impedance
