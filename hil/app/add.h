#pragma once
// `forcegate add`: one effect more, everything refitted, the step kept in the model's history.

#include "hil/app/fit.h"

namespace forcegate {

struct AddRequest {
  std::string effect;
  CampaignRequest campaign;
  std::filesystem::path output;  ///< model file to write
};

Result<diagnose::Refit> add_request(const AddRequest& request);

}  // namespace forcegate
