#pragma once
// The capacitance C_F as second witness of the force (Paredes-Madrid et al. 2010: it grows with the force, nearly linearly,
// and repeats better than the resistance). A zero of the reference that moves is seen by output and capacitance alike;
// a zero of the sensor's output that moves is seen by the output alone.

#include "hil/diagnose/diagnosis.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

struct CapacitanceWitness {
  enum class Side { unknown, reference, sensor } side = Side::unknown;
  /// Part of the output's slow departure from F_ref, as a force, that the capacitance shows too: 1 = the reference moves,
  /// 0 = the output moves.
  double share = 0.0, u_share = 0.0;
  std::size_t blocks = 0;  ///< behind it
};

/// Static records only (the decay of cyclic ones is the output's alone). Both channels are set against F_ref by a parabola of
/// the whole campaign; blocks of 30 s are averaged; u_share grows by (1 + r) / (1 - r) with what neighbouring blocks have in common. Unknown without C_F, with fewer than eight blocks, or when the share lies
/// between 0.35 and 0.65 within two standard uncertainties.
CapacitanceWitness hear_capacitance(const CampaignInput& input);

/// Side, side_witnessed and evidence of a finding "reference_drift" that has no wheel angle or command as witness.
void decide_by_capacitance(const CampaignInput& input, Finding& finding);

}  // namespace forcegate::diagnose
