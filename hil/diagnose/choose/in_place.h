#pragma once
// Effects that show right where they act, whichever law is fitted.

#include <string_view>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Whether the output shows the effect of this candidate where it acts; false where there is no test for it.
bool shows_in_place(const CampaignInput& campaign, const Candidate& candidate);

/// What it shows there, for people; empty where there is no test.
std::string_view what_shows_in_place(const EffectKind& kind);

}  // namespace forcegate::diagnose
