#pragma once
// `forcegate next`: what to measure next so that the rivals part.

#include "hil/app/diagnose.h"

namespace forcegate {

Result<NextExperiment> next_request(const CampaignRequest& request);
std::string next_text(const NextExperiment& next);
std::string next_json(const NextExperiment& next);

}  // namespace forcegate
