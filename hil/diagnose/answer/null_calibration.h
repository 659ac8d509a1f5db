#pragma once
// What chance does on the user's own records: the residual of the final model is turned over in whole records and
// screened again with the same machinery, so that autocorrelation within a record and the scatter between records are
// kept. n counts records.

#include <map>
#include <string>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

struct NullCalibration {
  std::map<std::string, double> score;  ///< family: largest score on the flipped records
  double expected_false = 0.0;  ///< mean number of families per flip whose score reaches its threshold
  int flips = 0;
};

/// `rules`: those by which the channel's families are considered.
NullCalibration calibrate_null(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& final,
                               const std::vector<std::string>& skip,
                               const SelectionRules& rules, int flips, unsigned threads);

}  // namespace forcegate::diagnose
