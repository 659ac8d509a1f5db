#pragma once
// Rows of whole recordings for verbs that ask a model and fit nothing, from the samples that a fit would use.

#include "hil/base/result.h"
#include "hil/model/rows.h"

namespace forcegate {

/// make_campaign_input of samples without hum and with the reference smoothed, as a diagnosis has them; a row with a spike, a lost or held
/// sample or one at a rail is not ok. Which records are cyclic is decided as there. Errors: those of make_campaign_input.
Result<CampaignInput> clean_input(Campaign campaign, unsigned threads, const RowParts& parts = {});

/// One sentence that names the records which nobody declared and whose swing decays: the law's decay applies to them. "" where there is none.
std::string note_of_assumed_cycles(const std::vector<RecordInput>& records);

}  // namespace forcegate
