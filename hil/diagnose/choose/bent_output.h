#pragma once
// What lags behind a bent curve. Effects add, each by its tangent at the force; of a sensor that is bent much the lag, the loop or the delay of
// what the curve adds is then missing, and an effect that knows a load takes it for its own. Seen by the force that a straight sensor would have
// felt, what is behind the curve is a plain one again.

#include <optional>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// A static curve of the force, in newtons, that leaves the ends of the campaign's range where they are and rises throughout.
struct Bend {
  std::vector<double> F_N, bent_N;  ///< rising, equally spaced in F
  double departure = 0.0;           ///< largest distance from the straight line between the ends, share of the range

  /// Beyond the ends along the last slope.
  double at(double force_N) const;
};

/// Of a finding of static_nonlinearity; of one that lags with the model's lag the curve alone; none where it does not rise.
std::optional<Bend> bend_of(const CampaignInput& campaign, const Finding& curve);

/// A bend beside the model's lag.
struct LaggedBend {
  Bend bend;
  double tau_s = 0.0;      ///< of the lag
  bool after_lag = false;  ///< the curve is one of the lagged force; else the bent force lags
};

/// Whatever curve describes the records best beside a lag of one pole, in the better order, steps of a touch among it. None:
/// the model has no such lag, or the curve does not rise.
std::optional<LaggedBend> bend_beside_lag(const Workspace& workspace, unsigned threads);

/// The force as a straight sensor would have felt it, behind a pole of `lag_s` before it is bent.
void bend_force(CampaignInput& campaign, const Bend& bend, double lag_s = 0.0);

}  // namespace forcegate::diagnose
