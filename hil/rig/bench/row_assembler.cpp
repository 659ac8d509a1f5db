#include "hil/rig/bench/row_assembler.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace forcegate {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kWindow_s = 2.0;  // of the arrivals that the clock looks back on
constexpr double kKept_s = 0.5;    // of readings, beyond the time that is known to be needed
constexpr double kTravelTolerance_rad = 1e-3;
constexpr double kLongestHole = 2.0;  // in the board's samples, of the time that it may be silent
constexpr std::size_t kRefineBack = 200;

}  // namespace

void RowAssembler::begin(double now_s, double theta_rad) {
  index_ = block_first_ = refined_ = arrived_ = 0;
  clock_.begin(facts_.rate_Hz, kWindow_s);
  pending_.clear();
  // a row is asked for as late as the board may be silent, and looked at again until kRefineBack others have come
  const double keep_s = facts_.board_stale_s + facts_.reference_stale_s + kKept_s + static_cast<double>(kRefineBack) / facts_.rate_Hz;
  forces_.begin(keep_s);
  angles_.begin(now_s, theta_rad, keep_s);
  last_code_ = 0;
  motor_fault_ = false;
  offset_s_ = now_s + 1.0 / facts_.rate_Hz;
}

void RowAssembler::take(const MotorState& state) {
  motor_fault_ = state.fault;
  angles_.take(state.t_s, state.theta_rad);
}

Result<void> RowAssembler::take(const BoardSample& sample, double now_s) {
  // longer than a board may be silent: its indices are damaged
  if (static_cast<double>(sample.index) - static_cast<double>(arrived_) > kLongestHole * facts_.board_stale_s * facts_.rate_Hz)
    return fail(ErrorCode::device, fmt::format("the board's sample {} is followed by sample {}", arrived_, sample.index), "board",
                "look for a disturbed line, and whether the board restarts or counts its samples wrongly");
  // The distance in time that a hole in the indices stands for is told by the index itself.
  for (; arrived_ < sample.index; ++arrived_) {
    clock_.next(now_s);
    pending_.push_back({{static_cast<std::uint32_t>(arrived_), 0, kNaN, 0}, true});
  }
  offset_s_ = clock_.next(now_s) - static_cast<double>(sample.index) / facts_.rate_Hz;
  ++arrived_;
  pending_.push_back({sample, false});
  return {};
}

void RowAssembler::begin_block(std::size_t at) { block_first_ = index_ - std::min<std::uint64_t>(at, index_); }

std::optional<BoardSample> RowAssembler::fill(RigBlock& out, std::size_t row, double commanded_rad_per_s) {
  const auto [sample, lost] = pending_.front();
  pending_.pop_front();
  const double t_s = time_s(index_);
  out.t_s[row] = static_cast<double>(index_) / facts_.rate_Hz;
  std::uint16_t status = motor_fault_ ? kRigMotorFault : 0;
  if (lost) {
    status |= kRigSampleLost;
    out.adc[row] = last_code_;
  } else {
    out.adc[row] = last_code_ = sample.adc;
    if (sample.adc == 0 || sample.adc == (1U << facts_.adc_bits) - 1U) status |= kRigAdcRail;
  }
  const double theta = angles_.at(t_s);
  out.theta_rad[row] = static_cast<float>(theta);
  if ((theta >= facts_.theta_max_rad - kTravelTolerance_rad && commanded_rad_per_s > 0.0) ||
      (theta <= facts_.theta_min_rad + kTravelTolerance_rad && commanded_rad_per_s < 0.0))
    status |= kRigTravelStop;
  out.status[row] = status;
  set_force(out, row, t_s);
  ++index_;
  return lost ? std::nullopt : std::optional(sample);
}

// True when the value is final: a reading behind the row exists.
bool RowAssembler::set_force(RigBlock& out, std::size_t row, double t_s) const {
  constexpr std::uint16_t kMask = kRigReferenceSaturated | kRigReferenceFault;
  out.status[row] = static_cast<std::uint16_t>(out.status[row] & ~kMask);
  const ForceAt force = forces_.at(t_s, facts_.reference_stale_s);
  out.force_ref_N[row] = force.force_N;
  out.status[row] = static_cast<std::uint16_t>(out.status[row] | force.status);
  return force.is_final;
}

void RowAssembler::refine(RigBlock& out, std::size_t rows) {
  refined_ = std::max(refined_, block_first_);
  const std::uint64_t end = block_first_ + rows;
  bool final_so_far = true;
  for (std::uint64_t i = refined_; i < end; ++i) {
    const bool is_final = set_force(out, static_cast<std::size_t>(i - block_first_), time_s(i));
    final_so_far = final_so_far && is_final;
    if (final_so_far) refined_ = i + 1;
  }
  if (end > kRefineBack) refined_ = std::max(refined_, end - kRefineBack);
}

}  // namespace forcegate
