#pragma once
// What lags behind a bent curve. Effects add, each by its tangent at the force; of a sensor that is bent much the lag, the loop or the delay of
// what the curve adds is then missing, and an effect that knows a load takes it for its own. Seen by the force that a straight sensor would have
// felt, what is behind the curve is a plain one again.

#include <optional>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// A static curve of the force, in newtons, that leaves the ends of the campaign's range where they are and rises throughout.
struct Bend {
  std::vector<double> F_N, bent_N;  ///< rising, equally spaced in F
  double slope_ratio = 1.0;         ///< of the steepest tenth to the flattest

  /// Beyond the ends along the last slope.
  double at(double force_N) const;
};

/// Of a finding of static_nonlinearity; of one that lags with the model's lag the curve alone; none where it does not rise.
std::optional<Bend> bend_of(const CampaignInput& campaign, const Finding& curve);

/// The force as a straight sensor would have felt it.
void bend_force(CampaignInput& campaign, const Bend& bend);

}  // namespace forcegate::diagnose
