#pragma once
// What the verbs of the diagnosis share: the model by name or file, the campaign with mapped columns.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/engine.h"
#include "hil/model/model.h"
#include "hil/trace/campaign.h"

namespace forcegate {

struct CampaignRequest {
  std::filesystem::path campaign;
  std::string model;              ///< a name of the library, or a file; "" = the library's model of the campaign's sensor
  std::vector<std::string> maps;  ///< "pressure_bar=F_ref_N"
  double assumed_rate_Hz = 0.0;
  unsigned threads = 0;
  std::string divider = {};  ///< "10k:5" (hil/trace/divider.h); "": none
  double late_s = 0.0;  ///< by which the output is known to be late behind the force
};

/// "": flexiforce.
Result<Model> load_model(const std::string& name_or_file);
/// What is told of a model whose output is in another unit than that of the records.
std::string note_of_another_unit(const Model& model, const Campaign& campaign);
/// The request's model, or the library's for the sensor that the campaign names; then a note of the campaign tells of any but flexiforce.
Result<Model> load_model(const CampaignRequest& request, Campaign& campaign);
/// The files as they are, columns mapped.
Result<Campaign> load_recordings(const CampaignRequest& request);
/// The same, where every record must have force and output (check_channels).
Result<Campaign> load_campaign(const CampaignRequest& request);
/// Every record needs a force and an output. `maps` are those that were asked for. Errors: parse, with the columns that there are and how to map them.
Result<void> check_channels(const Campaign& campaign, const std::vector<std::string>& maps);
/// Where an error names a record, or a campaign that is one file: the file. Made before the engine takes the campaign.
class PlacesOf {
 public:
  PlacesOf(const Campaign& campaign, const std::filesystem::path& given);
  Error with_file(Error error) const;

 private:
  std::map<std::string, std::string> file_;  ///< by name
  std::map<std::string, std::string> days_;  ///< by file: how a clock is read as days that may count them
};
diagnose::EngineOptions engine_options(const Model& model, unsigned threads);

}  // namespace forcegate
