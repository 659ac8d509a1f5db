#include "hil/gate/blame.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

bool firmware_left_the_reference(const CaseRecord& record) {
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

bool silent_at_the_same_sample(const CaseRecord& before, const CaseRecord& again) {
  const auto silent = [](const CaseRecord& r) {
    return r.failure && r.failure->stage == CaseFailure::Stage::rig && r.failure->error.code == ErrorCode::timeout &&
           r.failure->error.where.starts_with("board") && r.failure->sample > 0;
  };
  return silent(before) && silent(again) && before.failure->sample == again.failure->sample;
}

std::string_view device_of(std::string_view where) {
  for (const std::string_view device : {"reference", "board", "motor"})
    if (where == device || (where.starts_with(device) && where.substr(device.size()).starts_with(":"))) return device;
  return {};
}

Blame blame_of_device(std::string_view where) {
  if (where.starts_with("reference")) return Blame::reference;
  if (where.starts_with("board")) return Blame::link;
  return Blame::rig;
}

}  // namespace forcegate
