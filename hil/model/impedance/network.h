#pragma once
// The network of Paredes-Madrid 2010, VI: two inputs (V_o, C_s), one hidden layer of two neurons, one output.
//   F = s_F (v0 + v1 tanh(a1) + v2 tanh(a2)) + m_F,   a_i = w_i0 + w_i1 (V_o - m_V)/s_V + w_i2 (C_s - m_C)/s_C

#include <array>
#include <cstdint>
#include <span>

#include "hil/base/result.h"

namespace forcegate::impedance {

/// Readings of one sensor on one level.
struct ForceReading {
  double force_N = 0;        ///< of the weights
  double output_V = 0;       ///< V_o under the direct source, eq. (8)
  double capacitance_F = 0;  ///< eq. (6)
};

struct Network {
  static constexpr std::size_t kWeights = 9;
  std::array<double, kWeights> weights{};  ///< w_10 w_11 w_12 w_20 w_21 w_22 v0 v1 v2
  double mean_V = 0, scale_V = 1, mean_F = 0, scale_F = 1, mean_N = 0, scale_N = 1;
  double training_rmse_N = 0;
  double force_N(double output_V, double capacitance_F) const;
};

/// Levenberg-Marquardt (MINPACK's, as in Eigen) with a small weight decay from `starts` seeded starts; the best on the training
/// data is kept. Same seed, same bits. Errors (parse): fewer than 18 readings, or readings that do not vary.
Result<Network> train_network(std::span<const ForceReading> readings, std::uint64_t seed, int starts = 6);

}  // namespace forcegate::impedance
