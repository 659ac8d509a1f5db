#pragma once
// How likely it is that a chosen effect is there at all, whatever its name.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Evidence between records is honest, since n counts records: posterior odds against prior odds of 1 : 16, of 1 : 4 where the cause was recorded
/// and differed, at most 0.98. Within records the evidence counts rows that hang together and is only a scale: 0.75, 0.90 or 0.98.
double probability_that_real(const CampaignInput& input, const ChannelFacts& channel, const ChosenEffect& chosen);

/// Whether what was recorded of the effect's cause differs plainly between the records.
bool cause_differs(const CampaignInput& campaign, const Candidate& candidate);

/// Nats of evidence within records that a factor e of probability takes, where the leader has `top` of it: such evidence hangs together.
double nats_of_a_factor(double top);

}  // namespace forcegate::diagnose
