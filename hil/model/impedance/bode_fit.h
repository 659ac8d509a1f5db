#pragma once
// The RC law on a frequency sweep (Paredes-Madrid 2010, V-A): which R_s and C_s, up to which frequency, and where to work.

#include <span>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/impedance/rc_reading.h"

namespace forcegate::impedance {

struct BodeFit {
  double conductance_S = 0, u_conductance_S = 0;  ///< 1/R_s at low frequency
  double capacitance_F = 0, u_capacitance_F = 0;  ///< C_s at low frequency
  double top_Hz = 0;                              ///< of the readings that were fitted
  double chi2_per_dof = 0;
  /// Where tan(phi) has fallen to 5/6 of eq. (9): 2 to 4 degrees, a departure that a reader sees in Fig. 6 (ours; the paper
  /// gives no rule). The same relative departure at every force, as the paper finds. NaN: not within the sweep.
  double divergence_Hz = 0, u_divergence_Hz = 0;

  /// phi by eq. (9), rad.
  double phase_rad(double f_Hz) const;
  /// A reading that the RC law does not explain: its conductance or capacitance differs from the fit by more than three
  /// standard uncertainties and 5 %.
  bool departs(const RcReading& reading) const;
};

inline constexpr std::size_t kFewestOfBodeFit = 8;  ///< sound readings up to its top_Hz
inline constexpr double kTopOfBodeFit_Hz = 6000.0;

/// Weighted least squares of G(f) = 1/R_s + g2 f^2 + g4 f^4 and C(f) = C_s - c2 f^2 - c4 f^4 over the readings up to
/// `top_Hz`: any causal loss that sets in above begins with these powers, so R_s and C_s are those of eq. (9) without its
/// bias. `common_u_rel`: what all readings share (R_g) and no fit averages out. Saturated readings are left out. Errors (parse): fewer than 8 readings up to top_Hz, or R_s not positive.
Result<BodeFit> fit_bode(std::span<const RcReading> sweep, double common_u_rel = 0.0, double top_Hz = kTopOfBodeFit_Hz);

/// Frequency to work at: among the sweep's, below `share` of (divergence - 2 u) of every fit, the one whose capacitance is
/// known best (smallest relative uncertainty averaged over the sweeps). NaN when a fit has no divergence.
double operating_frequency_Hz(std::span<const BodeFit> fits, std::span<const std::vector<RcReading>> sweeps,
                              double share = 0.9);

}  // namespace forcegate::impedance
