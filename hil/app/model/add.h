#pragma once
// `forcegate add`: one effect more, everything refitted, the step kept in the model's history.

#include "hil/app/model/fit.h"
#include "hil/report/record_pictures.h"

namespace forcegate {

struct AddRequest {
  std::string effect;
  CampaignRequest campaign;
  std::filesystem::path output;  ///< model file to write
};

Result<diagnose::Refit> add_request(const AddRequest& request);

/// The page: maps, spectra, turning points and records without and with the effect. Reads the campaign again.
Result<std::string> added_page(const AddRequest& request, const diagnose::Refit& refit, const std::string& command_line);

}  // namespace forcegate
