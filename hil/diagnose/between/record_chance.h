#pragma once
// How often chance does as well as a family of predictors did.
//
// The chance is exact up to the estimated weights: whitened residuals of the model without x are permuted over the records (Freedman
// and Lane 1983) and the whole search over predictors is repeated (Westfall and Young 1993). Few records have few orders: where none does
// clearly better, they are turned in random directions instead (Langsrud 2005), which is exact where the scatter is normal.
// What an order shows is weighed under the covariance of the likeliest model without x and under those without its shares of sessions, of cyclic
// records, or of either: x may take the place of any of them.

#include <cstdint>
#include <vector>

#include "hil/diagnose/between/record_regression.h"

namespace forcegate::diagnose {

/// Several series of the same records and what competes to explain each: the question that one family of effects asks.
struct RecordQuestion {
  RecordSeries series;
  std::vector<RecordPredictor> predictors;
};

struct RecordChance {
  double of_orders = 1.0;      ///< share of orders of the records, the same for all series, under which the family does as well as it did
  double of_directions = 1.0;  ///< the same of rotations where no order does clearly better (half a nat); else of_orders
};

/// Shares of `draws` orders and directions: (1 + hits)/(1 + n), or hits/n as soon as enough hits tell (Besag and Clifford 1991).
RecordChance chance_of_records(const std::vector<RecordQuestion>& questions, int draws, std::uint64_t seed);

/// Largest Bayes factor that a chance leaves room for, 1 from 1/e on (Sellke, Bayarri and Berger 2001).
double bayes_factor_bound(double chance);

}  // namespace forcegate::diagnose
