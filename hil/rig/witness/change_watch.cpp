#include "hil/rig/witness/change_watch.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "hil/rig/witness/rows.h"

namespace forcegate::witness {
namespace {
constexpr std::uint64_t kExamineEvery = 32;
constexpr double kMoved_N = 0.1;   // four resolutions of the Nano17
constexpr double kSteps = 20.0;    // of the converter: a film that has lost four fifths of its gain still makes four of them
constexpr float kLoaded_N = 0.6f;  // above the offset F0 of any sensor of the kind
constexpr double kJump = 0.02;     // of the converter's range, 0.1 N of a FlexiForce
constexpr float kStood_N = 0.06f;  // ATI from one sample to the next: two steps of the Nano17
constexpr double kCreep_s = 2.0;   // a code that goes this slowly tells of the film, not of the force
}  // namespace

ChangeWatch::ChangeWatch(const RigInfo& info)
    : geometry_(info.geometry), period_s_(1.0 / info.rate_Hz), sensor_moved_N_(std::max(kMoved_N, kSteps * info.force_max_N / static_cast<double>(last_code(info)))),
      last_code_(static_cast<std::uint16_t>(last_code(info))) {}

bool ChangeWatch::moves(Witness witness, float from, float to, double enough_N) const {
  if (witness == Witness::wheel_rad) return std::fabs(spring_force_N(geometry_, to) - spring_force_N(geometry_, from)) > enough_N;
  if (witness == Witness::force_N) return std::fabs(to - from) > enough_N;
  return std::fabs(to - from) > kJump * static_cast<double>(last_code_);
}

// Did the witness of a reading that has not changed for a while move? A film creeps: a code tells only within a short time.
void ChangeWatch::examine(Still& still, Witness witness, float now, double enough_N, double& longest_s) const {
  if (!still.moved) still.moved = moves(witness, still.witness, now, enough_N);
  const auto short_run = static_cast<std::uint64_t>(kCreep_s / period_s_) / kExamineEvery * kExamineEvery;
  if (!still.moved && witness == Witness::code && short_run > 0 && still.run % short_run == 0) still.witness = now;
  if (still.moved) longest_s = std::max(longest_s, static_cast<double>(still.run) * period_s_);
}

template <bool kSound>
void ChangeWatch::push(const RigBlock& block, std::size_t n) {
  const float *force_N = block.force_ref_N.data(), *theta = block.theta_rad.data();
  const std::uint16_t *code = block.adc.data(), *status = block.status.data();
  const std::uint16_t last_code = last_code_;
  const int jump = std::max(4, static_cast<int>(kJump * last_code));
  std::uint64_t jumps = 0, dead_run = dead_run_;
  float previous_N = previous_force_N_;
  std::uint16_t previous_code = previous_code_;
  Still reference = reference_, sensor = sensor_;
  // A reading in steps changes by chance: what follows from it is chosen without branches, only the rare cases jump.
  const bool wheel = geometry_.eccentricity_mm > 0.0;
  const Witness of_reference = wheel ? Witness::wheel_rad : Witness::code, of_sensor = wheel ? Witness::wheel_rad : Witness::force_N;
  const auto count = [this](Still& still, bool same, Witness witness, float now, double enough_N, double& longest_s, double& stale_s) {
    if (still.moved && !same) {
      stale_s += static_cast<double>(still.run) * period_s_;
      still.moved = false;
    }
    still.run = same ? still.run + 1 : 0;
    still.witness = same ? still.witness : now;
    if (still.run != 0 && still.run % kExamineEvery == 0) {
      Still seen = still;  // a copy: what a call may change cannot stay in registers
      examine(seen, witness, now, enough_N, longest_s);
      still = seen;
    }
  };
  for (std::size_t i = 0; i < n; ++i) {
    const float now_N = force_N[i];
    const std::uint16_t now_code = code[i];
    if (!kSound && no_reference(now_N, status[i])) {
      previous_N = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    count(reference, now_N == previous_N, of_reference, wheel ? theta[i] : static_cast<float>(now_code), kMoved_N, reference_frozen_s_, reference_stale_s_);
    // At a rail one code is what a sound sensor gives too: below F0 at the first, above the range at the last.
    const bool rail = now_code == 0 || now_code == last_code;
    const double stale_before_s = sensor_stale_s_;
    count(sensor, now_code == previous_code && !rail, of_sensor, wheel ? theta[i] : now_N, sensor_moved_N_, sensor_dead_s_, sensor_stale_s_);
    if (previous_code > clip_code_ && previous_code != last_code) clip_code_ = previous_code, clip_s_ = 0.0;
    if (previous_code == clip_code_) clip_s_ += sensor_stale_s_ - stale_before_s;
    if (now_code == 0 && now_N > kLoaded_N) {
      sensor_dead_s_ = std::max(sensor_dead_s_, static_cast<double>(++dead_run) * period_s_);
    } else {
      dead_run = 0;
    }
    // NaN before the first valid row: no step.
    jumps += std::abs(now_code - previous_code) > jump && std::fabs(now_N - previous_N) < kStood_N;
    previous_N = now_N;
    previous_code = now_code;
  }
  jumps_ += jumps;
  dead_run_ = dead_run;
  previous_force_N_ = previous_N;
  previous_code_ = previous_code;
  reference_ = reference;
  sensor_ = sensor;
}
template void ChangeWatch::push<true>(const RigBlock&, std::size_t);
template void ChangeWatch::push<false>(const RigBlock&, std::size_t);

void ChangeWatch::finish(std::uint16_t largest_code, RigObservation& o) const {
  const auto running_s = [this](const Still& still) { return still.moved ? static_cast<double>(still.run) * period_s_ : 0.0; };
  o.reference_frozen_s = reference_frozen_s_;
  o.reference_stale_s = reference_stale_s_ + running_s(reference_);
  o.sensor_dead_s = sensor_dead_s_;
  o.sensor_stale_s = sensor_stale_s_ + running_s(sensor_);
  if (clip_code_ == largest_code) o.sensor_clipped_s = clip_s_;
  o.sensor_jumps = jumps_;
}

}  // namespace forcegate::witness
