#include "hil/gate/blame.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

bool firmware_left_the_reference(const CaseRecord& record) {
  constexpr double kDeparture_N = 0.4;
  constexpr int kLastExtrema = 6;
  if (record.output.not_finite > 0) return true;
  double worst_N = record.output.departure_N;
  int seen = 0;
  for (auto at = record.pairs.rbegin(); at != record.pairs.rend() && seen < kLastExtrema; ++at)
    if (std::isfinite(at->ati_N) && std::isfinite(at->dut_N)) {
      worst_N = std::max(worst_N, std::fabs(at->dut_N - at->ati_N));
      ++seen;
    }
  return worst_N > kDeparture_N;
}

Blame blame_of_device(std::string_view where) {
  if (where.starts_with("reference")) return Blame::reference;
  if (where.starts_with("board")) return Blame::link;
  return Blame::rig;
}

}  // namespace forcegate
