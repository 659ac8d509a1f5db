#pragma once
// What the output may depend on although no effect of the library says so: the largest force so far, the size of the rate, a mass on a spring,
// harmonics of the wheel; within one recording the time, as a zero does that warms up. They are never claimed. They stand beside a name that is about to be claimed, which must explain more than they do.

#include <string>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate::diagnose {

struct UnnamedDependence {
  EffectKind kind;    ///< not of the registry; summary: "the largest force so far"
  std::string group;  ///< of the residual maps' coordinates: history, rate, angle, time
  bool is_late = false;  ///< it can be taken for effects of time alone, and is asked beside those
  bool tells_when = false;  ///< its first shape is a share of the recording
  bool is_simpler = false;  ///< than any effect: it needs to explain no more than the one beside which it stands
  bool is_blind = false;    ///< to the load: as good a name as an effect that explains as much
};

inline constexpr const char* kZeroWithTime = "a zero that goes with the time";

/// Those that the campaign's channels allow. Another machine's loops and lags are those of the library in the rough: the time alone is asked there.
std::vector<UnnamedDependence> unnamed_dependences(const CampaignInput& campaign);

}  // namespace forcegate::diagnose
