#pragma once
// `forcegate diagnose`: which physical effect is missing.

#include "hil/app/model/model_input.h"
#include "hil/report/record_pictures.h"

namespace forcegate {

/// `pictures`: filled for the page when it is wanted.
Result<Diagnosis> diagnose_request(const CampaignRequest& request, RecordPictures* pictures = nullptr);

/// What a user would take into the model next: the first claim on the sensor's side of the model whose error on records left
/// out falls with it. nullptr: none.
const Finding* worth_adding(const Diagnosis& diagnosis);

/// The answer as a person reads it on a terminal.
std::string diagnosis_text(const Diagnosis& diagnosis);

}  // namespace forcegate
