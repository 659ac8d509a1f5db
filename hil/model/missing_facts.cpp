#include "hil/model/missing_facts.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/base/some_of.h"

namespace forcegate {
namespace {

using Tells = std::function<bool(const RecordInput&)>;

/// Names of records that do not tell what others do; empty where all or none tell it. `asked`: of which records.
std::vector<std::string> silent(const CampaignInput& campaign, const Tells& tells, const Tells& asked = [](const RecordInput&) { return true; }) {
  std::vector<std::string> out;
  bool some = false;
  for (const RecordInput& r : campaign.records) {
    if (tells(r))
      some = true;
    else if (asked(r))
      out.push_back(r.name);
  }
  return some ? out : std::vector<std::string>{};
}

void note(CampaignInput& campaign, const std::vector<std::string>& names, const std::string& what, const std::string& follows) {
  if (!names.empty()) campaign.notes.push_back(some_of(names) + (names.size() > 1 ? " have no " : " has no ") + what + ", which other records have: " + follows);
}

bool drive_varies(const CampaignInput& campaign) {
  constexpr double kSame = 0.02;
  double low = HUGE_VAL, high = -HUGE_VAL;
  std::size_t told = 0;
  for (const RecordInput& r : campaign.records) {
    if (!std::isfinite(r.drive_mean_V)) continue;
    ++told;
    low = std::min(low, r.drive_mean_V);
    high = std::max(high, r.drive_mean_V);
  }
  return told == 1 || high - low > kSame * std::abs(high);
}

bool moves(const RecordInput& r) {
  const auto [low, high] = std::ranges::minmax(r.F_N);
  return low < high;
}

}  // namespace

void note_missing_facts(CampaignInput& campaign) {
  const auto note_cause = [&](const Tells& tells, const char* what, const std::string& asked, const char* where_few) {
    const std::vector<std::string> names = silent(campaign, tells);
    const std::size_t all = campaign.records.size();
    note(campaign, names, what, asked + (enough_tell(all - names.size(), all) ? " is asked of those alone that tell it" : where_few));
  };
  if (drive_varies(campaign))
    note_cause([](const RecordInput& r) { return std::isfinite(r.drive_mean_V); }, "drive_V, as a key or a column",
               "whether the output depends on the supply (bias)", " cannot be asked");
  constexpr const char* kNotUsed = " can be asked only as a course that nobody recorded, and that of the others is not used";
  note_cause([](const RecordInput& r) { return !r.temp_C.empty(); }, "temperature (temp_C), as a key or a column", "the effect of one (thermal)", kNotUsed);
  note_cause([](const RecordInput& r) { return !r.humidity.empty(); }, "humidity_pct, as a key or a column", "the effect of one (humidity)", kNotUsed);
  if (campaign.mountings == 0)
    note(campaign, silent(campaign, [](const RecordInput& r) { return !r.mounting_name.empty(); }), "mounting",
         "between two different ones either may be its own, and the mountings that are declared are not used (mounting is asked as if none were)");
  const auto geometry = [](const RecordInput& r) { return std::isfinite(r.eccentricity_mm) && std::isfinite(r.preload_mm); };
  constexpr std::ptrdiff_t kFewest = 3;  // records that tell the stiffness of the spring
  if (std::ranges::count_if(campaign.records, [&](const RecordInput& r) { return geometry(r) && !r.theta_rad.empty(); }) >= kFewest)
    note(campaign, silent(campaign, geometry, [](const RecordInput& r) { return !r.theta_rad.empty() && moves(r); }), "eccentricity_mm and preload_mm",
         "no stiffness is found for all, and the zero of the reference (reference_drift) is not asked of the wheel");
}

}  // namespace forcegate
