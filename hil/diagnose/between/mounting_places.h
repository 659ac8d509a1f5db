#pragma once
// Where the sensor was mounted anew, when nobody wrote it down: one to three steps of gain and zero between records. The library lists one
// candidate for two steps and one for three, which stands where the records like it best; all places are asked, and pay for the search.

#include <vector>

#include "hil/diagnose/between/record_regression.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// How many steps a candidate has whose places are sought: 1 to 3; 0 for mountings that were written down, and for everything else.
int unknown_steps(const Candidate& candidate);

/// All sets of first records of the mountings behind the first one, counted from one. A step stands for mountings where two of them at least
/// have two records: what one record shows may be that record. None where there are too many to ask.
std::vector<std::vector<int>> places_of_mountings(Eigen::Index records, int steps);

/// One level for each mounting, the first included: which one is the first must not matter.
RecordPredictor predictor_of_places(Eigen::Index records, const std::vector<int>& places);

/// Moves the candidates of several steps to the places that gain and zero of the records speak for most, beside `fit`.
void place_mountings(const CampaignInput& input, ResidualChannel& channel, const MixedFit& fit, unsigned threads);

/// The same of the output beside `present` columns, as a diagnosis does it: all records speak.
void place_mountings(Workspace& workspace, const std::vector<int>& present, const MixedFit* warm, unsigned threads);

}  // namespace forcegate::diagnose
