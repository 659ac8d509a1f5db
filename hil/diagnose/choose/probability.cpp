#include "hil/diagnose/choose/probability.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/diagnose/between/record_chance.h"

namespace forcegate::diagnose {

bool cause_differs(const CampaignInput& campaign, const Candidate& candidate) {
  const RecordedCause& cause = candidate.form->cause;
  if (!cause.of_record) return false;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const RecordInput& r : campaign.records)
    if (const double x = cause.of_record(r); std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
  return high - low >= cause.plain;
}

double probability_that_real(const CampaignInput& input, const ChannelFacts& channel, const ChosenEffect& chosen) {
  constexpr double kPlain = 40.0;  // nats
  if (!chosen.by_records()) return chosen.stands_out ? 0.75 : chosen.gain > kPlain ? 0.98 : 0.90;
  const double prior_odds = cause_differs(input, candidate_of(channel, chosen.variant)) ? 0.25 : 0.0625;
  double factor = std::exp(std::min(50.0, chosen.gain));
  if (chosen.gain <= chosen.records.gain) factor = std::min(factor, bayes_factor_bound(chosen.chance));
  const double odds = prior_odds * factor;
  return std::min(0.98, odds / (1.0 + odds));
}

double nats_of_a_factor(double top) { return 0.03 * std::max(0.0, top) + 6.0; }

}  // namespace forcegate::diagnose
