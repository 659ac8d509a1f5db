#pragma once
// What a campaign says of the air at once, one number a record: in a note, or as a list under a name that tells quantity and unit.

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "hil/trace/air_notes.h"

namespace forcegate {

/// Members of campaign.json by name: "note": "RH % per run: 47 56 54", "room_temp_degC": [21.4, 22.6, 23.0].
struct CampaignMembers {
  std::vector<std::pair<std::string, std::string>> texts;
  std::vector<std::pair<std::string, std::vector<double>>> lists;
};

/// In the order of the file's records, of which there are as many; empty: nothing is said. What stands first counts, texts before lists.
std::vector<AirNotes> air_of_runs(const CampaignMembers& members, std::size_t records);

}  // namespace forcegate
