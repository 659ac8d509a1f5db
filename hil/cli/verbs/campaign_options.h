#pragma once
// The campaign of a verb: its options, and the request they make.

#include "hil/app/model/model_input.h"
#include "hil/cli/command.h"

namespace forcegate {

/// Bound of --late either way, s.
inline constexpr double kLatest_s = 60.0;

/// --model.
Option model_row();
/// --divider.
Option divider_option();
/// --map, --rate, --divider, --late, --threads: how the files of a campaign are read and how many threads work on it.
std::vector<Option> campaign_rows();
/// CAMPAIGN.
Positional campaign_positional();
/// The campaign as the next command must name it: quoted, with the --map, --rate, --divider and --late that it was read with.
/// `later_s`: with an output that is so much later still.
std::string campaign_words(const Invocation& in, const std::string& campaign, double later_s = 0.0);
/// " --model MODEL" where one was given, for the next command; "" otherwise.
std::string model_words(const Invocation& in);
/// The model as it was given; "" when none was.
std::string named_model(const Invocation& in);
/// From the values of campaign_rows(). Errors: usage.
Result<CampaignRequest> campaign_request(const Invocation& in, const std::string& campaign,
                                         const std::string& model);

}  // namespace forcegate
