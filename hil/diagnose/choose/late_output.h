#pragma once
// A delay behind a lag that the model has as a guess. Neither is seen alone: a longer lag, one of another kind, and a bend that lags in its own
// way take most of a delay for theirs, so that the search finds nothing that has a name, or a slow growth. Lag, curve and delay are moved
// together here, and a delay is one where no other lag comes near.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// 0: none is seen.
struct LateOutput {
  double delay_s = 0.0, u_s = 0.0;  ///< u: k = 1, from the profile of the evidence
  double tau_s = 0.0;               ///< of the lag beside it
  double gain = 0.0;                ///< nats over the best lag of any form without a delay
  double share_left = 1.0;          ///< of what that one leaves beyond the instruments' (mean square)

  explicit operator bool() const { return delay_s > 0.0; }
};

/// Asks where the model has a guessed lag of one pole and no record decays by more than a tenth; else, and below what two clocks may differ by, none.
LateOutput late_output(const Workspace& workspace, unsigned threads);

/// The force as a sensor has felt it whose output is `delay_s` late.
void delay_force(CampaignInput& campaign, double delay_s);

}  // namespace forcegate::diagnose
