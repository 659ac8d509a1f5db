#include "hil/rig/witness/sensor_watch.h"

#include <algorithm>

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {
namespace {
constexpr double kLeastOfBlock = 10.0;  // groups
constexpr double kMoves_N2 = 0.04;      // variance of the ATI
constexpr double kFollows = 0.3;        // r^2; the slow FSR at 3 Hz still has 0.5
}  // namespace

SensorWatch::SensorWatch(const RigInfo& info) : last_code_(last_code(info)) {}

void SensorWatch::close_block() {
  const Block b = block_;
  block_ = {};
  if (b.n < kLeastOfBlock) return;
  const double vff = b.ff / b.n - b.f * b.f / (b.n * b.n), vcc = b.cc / b.n - b.c * b.c / (b.n * b.n);
  const double vfc = b.fc / b.n - b.f * b.c / (b.n * b.n);
  if (!(vff > kMoves_N2) || b.code_low < 1.0 || b.code_high > last_code_ - 1.0) return;
  ++blocks_;
  odd_ += !(vfc > 0.0 && vfc * vfc > kFollows * vff * vcc);
}

void SensorWatch::push(std::span<const GroupMean> groups) {
  for (const GroupMean& g : groups) {
    if (g.begins_block) close_block();
    Block& b = block_;
    b.n += 1.0;
    b.f += g.force_N, b.c += g.code, b.ff += g.force_N * g.force_N, b.fc += g.force_N * g.code, b.cc += g.code * g.code;
    b.code_low = std::min(b.code_low, g.code);
    b.code_high = std::max(b.code_high, g.code);
  }
}

void SensorWatch::finish(RigObservation& o) const {
  SensorWatch end = *this;
  end.close_block();
  o.sensor_blocks = end.blocks_;
  o.sensor_blocks_odd = end.odd_;
}

}  // namespace forcegate::witness
