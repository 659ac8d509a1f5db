#pragma once
// The campaign of a verb: its options, and the request they make.

#include "hil/app/model_input.h"
#include "hil/cli/command.h"

namespace forcegate {

/// --model.
Option model_row();
/// --map, --rate, --threads: how the files of a campaign are read and how many threads work on it.
std::vector<Option> campaign_rows();
/// CAMPAIGN.
Positional campaign_positional();
/// From the values of campaign_rows(). Errors: usage.
Result<CampaignRequest> campaign_request(const Invocation& in, const std::string& campaign,
                                         const std::string& model);

}  // namespace forcegate
