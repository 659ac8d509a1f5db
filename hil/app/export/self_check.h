#pragma once
// A header is held against the model that it was made of before anybody builds it into firmware: forces over the range of the model, answered by
// the model, inverted by the built header.

#include <string>

#include "hil/app/export/compensator_check.h"

namespace forcegate {

struct SelfCheck {
  bool made = false;
  std::string why_not;     ///< where it was not made: no C compiler, no folder for it
  double largest_N = 0.0;  ///< |header - model's own inverse|
  double at_N = 0.0;       ///< force at which it is
  double low_N = 0.0, high_N = 0.0;  ///< range that was tried
};

/// A slow and a fast swing over the range, at rest and under decay; beside equations with states one that rattles, also behind a long decay. Errors (config): the header does not undo the model, with the force and the
/// difference; it does not compile.
Result<SelfCheck> self_check(const Model& model, const Compensator& compensator, double rate_Hz);

}  // namespace forcegate
