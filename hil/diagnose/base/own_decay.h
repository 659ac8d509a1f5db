#pragma once
// Whether and how fast the swing of one record decays, asked of that record alone.

#include <cstddef>
#include <vector>

#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// U = c0 + s(F, F', F'') + c6 T F + c7 T - c8 (1 - e^(-b t))(F - Fmin), s = c1 F + c2 F' + c3 F'' + c4 F^2 + c5 sqrt(F), least squares at a
/// grid of rates; without the last column it is a static record. F' and F'' take what lag, delay and loop add, F^2 and sqrt(F) the curve of an
/// FSR: beside them a decay of a record of fast edges, or of a bent sensor, would explain little of the misfit. A recorded temperature T takes
/// what it does to gain and zero, up to 3 % per degree, which would be taken for a decay.
struct OwnDecay {
  double rate_per_s = 0.0;
  double depth = 0.0;  ///< c8 over the slope of s: its covariance with F over the variance of F
  double static_mean_square = 0.0, mean_square = 0.0;  ///< V^2

  /// It explains most of what the other columns leave, and is 3 % deep; where others of the sensor's records decay so, a tenth and half a percent: edges
  /// that the columns of lag do not follow leave more than a small decay does.
  bool is_decay(bool others_decay = false) const;
};

/// Whether one of them is a decay by itself, beside which less is enough for the others.
bool some_decay(const std::vector<OwnDecay>& records);

/// A rate of the grid is off by up to a third of itself. That is enough where a fit begins with it; what a decay leaves needs the rate between.
enum class Rates { of_grid, between };
OwnDecay own_decay(const RecordInput& record, const std::vector<std::size_t>& rows, Rates rates = Rates::of_grid);

/// Whether a decay of the swing, of any rate and depth, explains most of what a straight line leaves of the record.
bool decays_by_itself(const RecordInput& record);
/// The same of nearly all that any record without a decay leaves: so plain that few turns are enough.
bool decays_plainly(const RecordInput& record);
/// F_min, N, about which the swing of a cyclic record decays: another one that may be meant (RecordInput::other_F_min_N) where the record's own
/// decay is clearly less by it, what was found otherwise.
double lowest_force_of_decay(const RecordInput& record);
/// Of cyclic records: their lowest force so, and where nobody declared the cycling and the swing does not decay by itself, they are static: as a
/// comparison takes them, whatever law it is compared with.
void settle_excitations(std::vector<RecordInput>& records, unsigned threads);
/// Mean square, V^2, that a straight line whose slope decays from the record's onset on leaves of it, at the best rate and depth.
double left_by_decay(const RecordInput& record);

/// Whether records move to and fro without a decay and none is there that decays: a law of decay that no record shows and some contradict would
/// bend every later record.
bool none_decays(const CampaignInput& campaign);

}  // namespace forcegate::diagnose
