#include "hil/app/model/clean_input.h"

#include "hil/base/largest_first.h"
#include "hil/base/text.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/raw/absurd_force.h"
#include "hil/diagnose/raw/clean_samples.h"
#include "hil/diagnose/raw/missing_code.h"
#include "hil/diagnose/raw/stuck_bit.h"

namespace forcegate {

Result<CampaignInput> clean_input(Campaign campaign, unsigned threads, const RowParts& parts) {
  diagnose::leave_out_missing_codes(campaign, campaign.notes);
  diagnose::leave_out_absurd_force(campaign, threads, campaign.notes);
  diagnose::mend_stuck_bit(campaign, campaign.notes);
  diagnose::note_cleaning(campaign.bench, campaign.notes);
  const diagnose::HealthScales scales = diagnose::health_scales(campaign, threads);
  std::vector<std::vector<std::uint8_t>> bad(campaign.records.size());
  parallel_for_largest_first(sample_counts(campaign), threads, [&](std::size_t k) {
    bad[k] = diagnose::clean_samples(campaign.records[k], scales, campaign.bench, false).health.bad;
  });
  FORCEGATE_TRY(CampaignInput out, make_campaign_input(campaign, threads, parts, bad));
  diagnose::settle_excitations(out.records, threads);
  return out;
}

std::string note_of_assumed_cycles(const std::vector<RecordInput>& records) {
  std::vector<std::string> names;
  for (const RecordInput& r : records)
    if (r.dynamic && r.dynamic_assumed) names.push_back(r.name);
  if (names.empty()) return {};
  return "nobody declared whether " + join(names, ", ") + (names.size() == 1 ? " is" : " are") +
         " cycled, and the swing of the output decays: the decay of the law is in what the model says of " + (names.size() == 1 ? "it" : "them") +
         " (\"dynamic\" in campaign.json declares it)";
}

}  // namespace forcegate
