#pragma once
// Effects that change gain or zero from record to record, judged where they act: on one gain and one zero for each record.
// The mixed model's evidence counts rows; here n counts records, spreads are integrated out, and no prior keeps them wide.

#include <string>
#include <vector>

#include "hil/diagnose/between/record_regression.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// What the records say about a channel's first two columns of Z, gain and zero: estimates with these two free and everything
/// else within its spread; and what the same linear map makes of every column of S.
struct RecordLevels {
  RecordSeries gain, zero;
  std::vector<double> start_s;  ///< of each record; its number where nobody wrote the times down
  Eigen::MatrixXd gain_of_column, zero_of_column;  ///< records x ns
};
RecordLevels record_levels(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& fit);

/// Judges the families that act between records anew, sets their gain, best variant and `records`, and sorts the ranking. A family that
/// shows within records too keeps the larger of its two gains.
void judge_between_records(const CampaignInput& input, const ResidualChannel& channel, const std::vector<int>& present, const SelectionRules& rules, ScreenResult& result);

/// Whether its evidence is that of one number for each record, and not that of the rows within them.
bool asks_between_records(const FamilyScore& family);

/// What a family ranks by: its gain, and the prior of a cause that nobody recorded where the levels of the records are its evidence.
double standing(const FamilyScore& family);

/// From which RMS on (share of the span, over all records) the family would pass on these records: what its best variant adds is
/// taken away from the records and put back at growing size, until the rule that claims is met; 0 where it never is.
double visible_between_records(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                               const SelectionRules& rules);

/// What one number for each record says against a claim.
struct RecordTest {
  Refusal objection = Refusal::none;
  double chance = 1.0;    ///< that the records in another order show as much; tested where nothing else stands against it
};
RecordTest test_records(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                        const SelectionRules& rules);

}  // namespace forcegate::diagnose
