#pragma once
// `forcegate diagnose`: which physical effect is missing.

#include "hil/app/model_input.h"

namespace forcegate {

Result<Diagnosis> diagnose_request(const CampaignRequest& request);

/// The answer as a person reads it on a terminal.
std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace forcegate
