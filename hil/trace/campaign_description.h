#pragma once
// campaign.json: what it says of the bench and of each record, before any sample is read.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/trace/air_lists.h"
#include "hil/trace/air_notes.h"
#include "hil/trace/campaign.h"
#include "hil/trace/lab_notes.h"

namespace forcegate {

struct DescribedRecord {
  Record facts;       ///< without samples
  LabNotes notes;     ///< in words
  AirNotes air;       ///< in words, where no key tells it
  std::optional<double> cycles_before;  ///< in words
  std::string file;   ///< as written, relative to the folder of campaign.json
  std::string where;  ///< place in campaign.json
};

struct CampaignDescription {
  std::string name, sensor;
  BenchFacts bench;
  std::vector<std::string> notes;                       ///< keys that look mistyped
  std::optional<std::vector<DescribedRecord>> records;  ///< nothing when campaign.json lists none
  CampaignMembers members;                              ///< what it says of all records at once
};

/// Errors name file, line and column. io: the file cannot be opened; parse: no JSON, a value of the wrong type, or one that no instrument
/// has (a negative noise, a converter without bits).
Result<CampaignDescription> read_description(const std::filesystem::path& file);

}  // namespace forcegate
