#pragma once
// Turns of the force by rows. Unlike hil/trace/extrema.h it counts the first extreme of a record too, and knows from which row on one is seen.

#include <cstddef>
#include <vector>

namespace forcegate::diagnose {

struct ForceTurn {
  std::size_t row = 0;      ///< the first of the highest, or lowest
  std::size_t seen_at = 0;  ///< row where the force has come back by more than the prominence
  bool is_highest = false;
};

/// Highest and lowest in turn; `prominence` in newtons.
std::vector<ForceTurn> force_turns(const std::vector<double>& F_N, double prominence);

}  // namespace forcegate::diagnose
