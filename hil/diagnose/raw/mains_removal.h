#pragma once
// Hum taken out of the samples before any fit: at low rates it does not average away over a row and hides whatever else is there.
//   U = smooth + g F + sum_h p_h(F, t) sin(2 pi h f t) + q_h(F, t) cos(2 pi h f t),  h = 1, 3;  p, q linear in 1, F, F^2 and t
// by least squares in windows of some seconds; f near the mains, one for the record. What it picks up grows where the sensor's resistance
// is high, hence F; the mains wander, hence t. A harmonic that the sampling folds onto the slow force is left alone.

#include <cstdint>
#include <span>
#include <vector>

namespace forcegate::diagnose {

/// Takes the line off `U_V` and returns the mean square of what it took, V^2. `mains_Hz`: one of kMains_Hz. `rate_Hz`: of the samples between gaps.
/// Samples in `bad` have no say. The clock may have gaps and jitter, and stamps of few digits.
double remove_mains_line(const std::vector<double>& t_s, const std::vector<double>& F_N, std::span<const std::uint8_t> bad, double mains_Hz,
                         double rate_Hz, std::vector<double>& U_V);

}  // namespace forcegate::diagnose
