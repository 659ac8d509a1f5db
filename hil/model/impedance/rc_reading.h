#pragma once
// R_s and C_s of a sensor in the circuit of Paredes-Madrid 2010, Fig. 3a, from what was read at the output.

#include "hil/model/impedance/lock_in.h"

namespace forcegate::impedance {

/// What is known of the circuit; u_rel are relative standard uncertainties.
struct Circuit {
  double feedback_ohm = 0, feedback_u_rel = 0;             ///< R_g
  double gain_bandwidth_Hz = 0, gain_bandwidth_u_rel = 0;  ///< 0: amplifier taken as ideal
};

struct RcReading {
  double f_Hz = 0;
  double amplitude_V = 0;                 ///< A_o of eq. (5)
  double phase_rad = 0, u_phase_rad = 0;  ///< phi of eq. (5), between 0 and pi/2 for R parallel C
  double conductance_S = 0, u_conductance_S = 0;
  double capacitance_F = 0, u_capacitance_F = 0;
  bool saturated = false;  ///< clipped samples, or a third harmonic above 1 % and above its noise
  double resistance_ohm() const { return 1.0 / conductance_S; }
  double u_resistance_ohm() const { return u_conductance_S / (conductance_S * conductance_S); }
};

/// Eq. (4) to (7) solved for R_s and C_s: V_o/V_s = -R_g (1/R_s + j 2 pi f C_s), corrected for one pole of the amplifier.
/// Uncertainty: noise of the phasor (type A); R_g and the gain-bandwidth product (type B). Source amplitude
/// and phase are exact.
RcReading rc_reading(const Phasor& phasor, double source_V, double f_Hz, const Circuit& circuit);

/// Eq. (8): conductance by a direct voltage; f_Hz = 0, no capacitance.
RcReading dc_reading(const Level& level, double source_V, const Circuit& circuit);

}  // namespace forcegate::impedance
