#pragma once
// What the verbs of the diagnosis share: the model by name or file, the campaign with mapped columns.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/engine.h"
#include "hil/model/model.h"
#include "hil/trace/campaign.h"

namespace forcegate {

struct CampaignRequest {
  std::filesystem::path campaign;
  std::string model;               ///< "" = flexiforce; a name of the library, or a file
  std::vector<std::string> maps;   ///< "pressure_bar=F_ref_N"
  double assumed_rate_Hz = 0.0;
  unsigned threads = 0;
};

Result<Model> load_model(const std::string& name_or_file);
Result<Campaign> load_campaign(const CampaignRequest& request);
diagnose::EngineOptions engine_options(const Model& model, unsigned threads);

}  // namespace forcegate
