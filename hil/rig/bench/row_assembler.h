#pragma once
// Rows of a bench out of what its three instruments say, each at its own pace.
//
// The board's conversions are the rows and their clock: sample i of a stream is row i. A row is placed on the bench's time by the earliest
// arrivals of frames (hil/base/arrival_clock.h); reference and wheel angle are interpolated to it. Where the next reading of the
// reference has not come yet, the last one stands in until it has.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "hil/base/arrival_clock.h"
#include "hil/base/result.h"
#include "hil/interface/device.h"
#include "hil/interface/rig.h"
#include "hil/rig/bench/passed_readings.h"

namespace forcegate {

struct RowFacts {
  double rate_Hz = 1000.0;  ///< of the board's samples
  int adc_bits = 16;
  double theta_min_rad = 0.0, theta_max_rad = 0.0;  ///< travel of the wheel
  double board_stale_s = 0.0;                       ///< for this long the board may be silent
  double reference_stale_s = 0.0;                   ///< so far away may a reading be that stands for a row
};

class RowAssembler {
 public:
  explicit RowAssembler(const RowFacts& facts) : facts_(facts) {}

  /// A stream of the board begins at bench time now_s, its wheel at theta_rad.
  void begin(double now_s, double theta_rad);

  void take(const MotorState& state);
  /// In order, as read at bench time now_s. Indices that were passed over become rows with kRigSampleLost. Error (device): so many of them that
  /// the indices themselves are damaged.
  Result<void> take(const BoardSample& sample, double now_s);
  void take(const std::vector<ReferenceReading>& fresh) { forces_.take(fresh); }

  /// Index of the next row, and how many can be filled.
  std::uint64_t index() const { return index_; }
  std::size_t waiting() const { return pending_.size(); }
  /// Bench time at which the n-th of the next rows has been measured, n > 0, as far as the arrivals tell.
  double due_s(std::size_t n) const { return time_s(index_ + n - 1); }

  /// The next row is row `at` of a block, and those before it are the rows before it.
  void begin_block(std::size_t at);
  /// The next row; waiting() > 0. Its sample, none where it was lost: the row then has the code before it.
  std::optional<BoardSample> fill(RigBlock& out, std::size_t row, double commanded_rad_per_s);
  /// Of the first `rows` of the block those that still stood on the last reading before them, if no more than the last 200.
  void refine(RigBlock& out, std::size_t rows);

 private:
  double time_s(std::uint64_t index) const { return offset_s_ + static_cast<double>(index) / facts_.rate_Hz; }
  bool set_force(RigBlock& out, std::size_t row, double t_s) const;

  struct Arrival {
    BoardSample sample;
    bool lost;  ///< a hole in the indices stands for it
  };
  RowFacts facts_;
  ArrivalClock clock_;
  double offset_s_ = 0.0;  ///< bench time of sample 0
  std::uint64_t index_ = 0, block_first_ = 0, refined_ = 0, arrived_ = 0;
  std::deque<Arrival> pending_;
  PassedForces forces_;
  PassedAngles angles_;
  std::uint16_t last_code_ = 0;
  bool motor_fault_ = false;
};

}  // namespace forcegate
