#pragma once
// Every family beside the base model: its evidence, what it explains alone and only it, and from which size on these
// records would show it.

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

void add_ranking(const CampaignInput& input, const ResidualChannel& channel, const Selection& selection, const SelectionRules& rules,
                 Diagnosis& out);

/// What stands among the findings has one probability, theirs: the ranking's own is a share among rivals. After the findings are decided.
void state_probabilities(Diagnosis& out);

/// What acts from record to record hides in the records' own scatter: a note says how much of it there may be.
void tell_visible_from(Diagnosis& out);

}  // namespace forcegate::diagnose
