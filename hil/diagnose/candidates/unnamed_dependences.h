#pragma once
// What the output may depend on although no effect of the library says so: the largest force so far, the size of the rate, a mass on a spring,
// harmonics of the wheel. They are never claimed. They stand beside a name that is about to be claimed, which must explain more than they do.

#include <string>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate::diagnose {

struct UnnamedDependence {
  EffectKind kind;    ///< not of the registry; summary: "the largest force so far"
  std::string group;  ///< of the residual maps' coordinates: history, rate, angle
  bool is_late = false;  ///< it can be taken for effects of time alone, and is asked beside those
};

/// Those that the campaign's channels allow.
std::vector<UnnamedDependence> unnamed_dependences(const CampaignInput& campaign);

}  // namespace forcegate::diagnose
