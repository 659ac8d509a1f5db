#include "hil/diagnose/candidates/cause_course.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

bool runs_within_records(const CampaignInput& campaign, const Candidate& candidate) {
  constexpr double kRuns = 0.25;
  if (!candidate.form->cause.of_rows) return false;
  double low = INFINITY, high = -INFINITY, run = 0.0;
  for (const RecordInput& r : campaign.records) {
    double low_here = INFINITY, high_here = -INFINITY;
    for (const double x : candidate.form->cause.of_rows(campaign, r, candidate.shape))
      if (std::isfinite(x)) low_here = std::min(low_here, x), high_here = std::max(high_here, x);
    low = std::min(low, low_here);
    high = std::max(high, high_here);
    run = std::max(run, high_here - low_here);
  }
  return run > kRuns * (high - low);
}

}  // namespace forcegate::diagnose
