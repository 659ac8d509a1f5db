#include "hil/app/model_input.h"

#include <algorithm>

namespace forcegate {

Result<Model> load_model(const std::string& name) {
  if (name.empty()) return library_model("flexiforce");
  const std::vector<std::string> known = library_model_names();
  if (std::find(known.begin(), known.end(), name) != known.end()) return library_model(name);
  return read_model(name);
}

Result<Campaign> load_campaign(const CampaignRequest& request) {
  CampaignOptions options;
  options.assumed_rate_Hz = request.assumed_rate_Hz;
  for (const std::string& map : request.maps) {
    const std::size_t at = map.find('=');
    if (at == std::string::npos || at == 0 || at + 1 == map.size())
      return fail(ErrorCode::usage, "\"" + map + "\" does not map a column", "--map", "write --map pressure_bar=F_ref_N");
    options.column_map[map.substr(0, at)] = map.substr(at + 1);
  }
  return read_campaign(request.campaign, options);
}

diagnose::EngineOptions engine_options(const Model& model, unsigned threads) {
  diagnose::EngineOptions out;
  out.law = model.law;
  out.model_name = model.name;
  out.in_model = model.effect_names();
  out.threads = threads;
  return out;
}

}  // namespace forcegate
