#pragma once
// What the shares and differences in the columns of effects refer to. A strength is a number of the campaign that it was fitted on:
// a play of 6 % of the span, a gain of 1 %/degC from its mean temperature on. The frame goes with the model, so that it is the same model
// on every other campaign.

#include "hil/model/record_input.h"

namespace forcegate {

/// kMissing: the model does not say, and the campaign's own stands for it.
struct ModelFrame {
  double span_N = 5.0;             ///< force span, > 0
  double lowest_N = kMissing;      ///< where it begins
  double temperature_C = kMissing, humidity_pct = kMissing;  ///< where effects of the air are zero
  double drive_V = kMissing;       ///< where those of the drive are, not 0
  double travel_N = kMissing;      ///< sum |dF| at which wear is complete, > 0
};

/// The frame of strengths that are fitted on this campaign.
ModelFrame frame_of(const CampaignInput& campaign);

/// A campaign on which the effects of a model mean what they meant where it was fitted.
class CampaignInFrame {
 public:
  CampaignInFrame(const ModelFrame& frame, CampaignInput campaign);
  const CampaignInput& input() const { return input_; }

 private:
  CampaignInput input_;
};

/// Where effects of temp_C, humidity and the drive are zero on this campaign: the frame's, else the mean over its records.
/// None of them has the channel: 0, 0, 1 V.
double reference_temperature_C(const CampaignInput& campaign);
double reference_humidity_pct(const CampaignInput& campaign);
double reference_drive_V(const CampaignInput& campaign);
/// Holds those of the air, which every column of its effects asks for and which are means over all rows.
void hold_references_of_air(CampaignInput& campaign);

}  // namespace forcegate
