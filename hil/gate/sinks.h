#pragma once
// What looks at a record while it streams past. Every sink takes whole blocks, allocates nothing after
// begin() and uses memory independent of the record's length.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "hil/gate/case_record.h"
#include "hil/interface/rig.h"
#include "hil/trace/lag_fit.h"

namespace forcegate {

/// One block of a record: the rig's columns, the firmware's answer and the raw sensor force by eq. (1).
struct RecordBlock {
  const RigBlock* rig = nullptr;
  std::span<const float> dut_N;
  std::span<const std::uint8_t> flags;
  std::span<const float> raw_N;
  std::size_t n = 0;
};

/// Output bounds, NaN, flags, spikes.
class OutputWatch {
 public:
  static constexpr double kDeparture_s = 0.2;  ///< of OutputFacts::departure_N
  static constexpr double kSpike_s = 0.01;     ///< distance of the samples that a spike is held against
  static constexpr double kSpikeOfCode_s = 0.2;    ///< for this long after a spike of the code the output may have one
  static constexpr float kSpikeOfCode_N = 0.1f;
  void begin(double rate_Hz, double excitation_start_s);
  void push(const RecordBlock& block);
  OutputFacts finish() const { return facts_; }

 private:
  void push_flags(const RecordBlock& block);
  void push_spikes(const RecordBlock& block, std::size_t from, std::size_t to);
  void push_strange(const RecordBlock& block);  ///< the slow way, for a block with values that are not finite
  OutputFacts facts_;
  double period_s_ = 1e-3, excitation_start_s_ = 0.0, follow_ = 0.005;
  std::uint64_t learning_run_ = 0;
  std::vector<float> recent_dut_, recent_raw_;  ///< what came before, then the block; the last two kSpike_s stay
  std::size_t spike_rows_ = 0;
  std::uint64_t after_code_ = 0;
  bool first_episode_over_ = false, any_finite_ = false;
};

/// Constant set-point after cycling. The first kSettle_s of a hold belong to the firmware's detection.
class HoldWatch {
 public:
  static constexpr double kSettle_s = 30.0;
  void begin(double rate_Hz, double excitation_start_s);
  void push(const RecordBlock& block);
  HoldFacts finish() const;

 private:
  double rate_Hz_ = 1000.0, excitation_start_s_ = 0.0;
  float last_setpoint_N_ = 0.0f;
  std::uint64_t run_ = 0, counted_ = 0;
  double moved_N_ = 0.0;
  double dut_ = 0.0, raw_ = 0.0, ati_ = 0.0;
};

/// How the sensor's lag behind the ATI changes from the first to the second half of a record: what is left of the skew
/// of their clocks, seen in the signals themselves,
///   drift = (lag_2 - lag_1) / T,  T from the middle of the one half to that of the other,
/// in parts per million; positive: the sensor falls behind. It holds besides whatever else changes the lag. NaN when the
/// force hardly moves in one of the halves (hil/trace/lag_fit.h).
struct LagDrift {
  double first_lag_s = std::numeric_limits<double>::quiet_NaN(), second_lag_s = first_lag_s;
  double drift_ppm = first_lag_s, u_drift_ppm = first_lag_s;
};

/// Lag of the firmware, and of the raw sensor force, behind the ATI (hil/trace/lag_fit.h) on means over kGroup samples.
class LagEstimator {
 public:
  static constexpr int kGroup = 10;
  /// until_s: end of the record, whose halves are compared; infinity: they are not.
  void begin(double rate_Hz, double from_s, double until_s = std::numeric_limits<double>::infinity());
  void push(const RecordBlock& block);
  /// NaN when the force hardly moves.
  void finish(double& lag_s, double& u_lag_s) const { firmware_.finish(lag_s, u_lag_s); }
  /// Where the raw force is too late for a fit (a quarter of a period), by search.
  double raw_lag_s() const;
  LagDrift drift() const;

 private:
  double from_s_ = 0.0, half_s_ = 0.0, between_s_ = 0.0;
  bool second_half_ = false;
  int filled_ = 0;
  double sum_x_ = 0.0, sum_y_ = 0.0, sum_raw_ = 0.0;
  LagFit firmware_, raw_, raw_first_, raw_second_;
  LagSearch raw_far_;
};

/// Curves for pictures: `columns` pixel columns, each with the rows that hold first, last and the extremes of
/// ATI, firmware and their difference, so that no peak of trace or error is lost.
class Overview {
 public:
  void begin(std::uint64_t samples, std::size_t columns);
  void push(const RecordBlock& block);
  std::vector<PlotTrace> finish();

 private:
  struct Row {
    double t_s = 0.0;
    float value[4] = {};
  };
  enum Slot { first, ati_low, ati_high, dut_low, dut_high, error_low, error_high, last, kSlots };
  void close_column();
  std::uint64_t per_column_ = 1, in_column_ = 0;
  Row slot_[kSlots];
  float best_[kSlots] = {};
  std::vector<Row> rows_;
};

/// Rows of a stretch of the record around an instant that is worth a look, every stride-th sample, at most `capacity` of them. An instant
/// is known up to a block late: so many more rows are held.
class WindowKeeper {
 public:
  void begin(double rate_Hz, double length_s, std::size_t capacity, std::size_t block_rows);
  void push(const RecordBlock& block);
  /// Half the length before and after, as far as the record goes, in place of what was kept before.
  void around(double t_s);
  bool has_any() const { return wanted_; }
  std::vector<PlotTrace> finish();  ///< around the last instant, else the end of the record

 private:
  struct Row {
    double t_s = 0.0;
    float value[4] = {};
  };
  void keep_until(double end_s);
  std::vector<Row> ring_, kept_;
  std::size_t rows_ = 0, at_ = 0, filled_ = 0;
  std::uint64_t stride_ = 1, skip_ = 0;
  double length_s_ = 0.0, end_s_ = 0.0;
  bool wanted_ = false, open_ = false;  ///< open: what comes after the instant is still to be pushed
};

}  // namespace forcegate
