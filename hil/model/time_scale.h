#pragma once
// The times that a grid of shapes begins with, where nobody wrote down what a recording is of.

#include <algorithm>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate {

/// Factors for times that are meant for rows of `usual_s`: 1; of an undeclared recording whose rows are longer than that their ratio instead, since systems
/// that are sampled slowly are slow; and the ratio beside 1 where the force of a record is so fast that its rows are far shorter (hil/model/row_step.h).
inline std::vector<double> time_scales(const CampaignInput& campaign, double usual_s) {
  constexpr double kFarShorter = 0.25;
  if (campaign.records.empty()) return {1.0};
  const double shortest_s = std::ranges::min(campaign.records, {}, &RecordInput::row_step_s).row_step_s, ratio = shortest_s / usual_s;
  if (ratio < kFarShorter) return {ratio, 1.0};
  return {campaign.undeclared ? std::max(1.0, ratio) : 1.0};
}

}  // namespace forcegate
