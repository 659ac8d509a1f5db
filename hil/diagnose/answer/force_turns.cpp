#include "hil/diagnose/answer/force_turns.h"

namespace forcegate::diagnose {

std::vector<ForceTurn> force_turns(const std::vector<double>& F, double prominence) {
  std::vector<ForceTurn> out;
  std::size_t high = 0, low = 0;
  int direction = 0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (F[i] > F[high]) high = i;
    if (F[i] < F[low]) low = i;
    if (direction >= 0 && F[high] - F[i] > prominence) {
      out.push_back({high, i, true});
      direction = -1, low = i;
    } else if (direction <= 0 && F[i] - F[low] > prominence) {
      out.push_back({low, i, false});
      direction = 1, high = i;
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
