#include "hil/trace/air_lists.h"

#include "hil/trace/air_words.h"

namespace forcegate {
namespace {

void take(const std::vector<AirNotes>& said, std::vector<AirNotes>& out) {
  if (said.empty()) return;
  out.resize(said.size());
  for (std::size_t k = 0; k < said.size(); ++k) fill_in(out[k], said[k]);
}

}  // namespace

std::vector<AirNotes> air_of_runs(const CampaignMembers& members, std::size_t records) {
  std::vector<AirNotes> out;
  for (const auto& [key, text] : members.texts) take(air_in_list(key + " " + text, records), out);
  for (const auto& [key, numbers] : members.lists) {
    if (numbers.size() != records) continue;
    std::vector<AirNotes> listed;
    for (const double number : numbers) listed.push_back(air_notes({{key, number}}));
    take(listed, out);
  }
  return out;
}

}  // namespace forcegate
