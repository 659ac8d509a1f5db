#pragma once
// How much of a sudden change of the force a user's equation takes from the output: whether its inverse exists and what it does to noise.
//
//   s = min over histories of  [e(F + h) - e(F)] / h,   dF from F and the two samples before, states held, |F - F_before| <= span (dt / 0.2 s)
//
// Equations are text, so the slope is looked for, not derived: triangles, sines and holds over the span, a fine course at the sample rate
// and a long one that fills slow states.

#include "hil/base/result.h"
#include "hil/model/compensator/c_term.h"

namespace forcegate {

struct LeastSlope {
  double slope = 0.0;    ///< N/N: 0 when the output does not follow a sudden change; below -1 the sum with the law falls
  double force_N = 0.0;  ///< where
  bool falling = false;  ///< the force goes down there
};

/// Errors (config): those of UserEquation::make.
Result<LeastSlope> least_slope(const UserEffect& effect, const CTermContext& context);

}  // namespace forcegate
