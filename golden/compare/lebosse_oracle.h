#pragma once
// Oracle of algorithm "lebosse-eq7/1": what a firmware that declares this algorithm must answer to the same
// codes and calibration. Written in double precision from docs/algorithm.md; shares no line with any
// firmware. All decisions of the algorithm are comparisons of integers, so rounding cannot send oracle and
// firmware different ways; what is left is the rounding of the firmware's arithmetic.

#include <array>
#include <cstdint>
#include <vector>

#include "hil/interface/calibration.h"

namespace forcegate {

class LebosseOracle {
 public:
  static constexpr const char* kAlgorithm = "lebosse-eq7/1";

  /// The calibration as it crosses the link: single precision.
  explicit LebosseOracle(const Calibration& calibration);

  struct Output {
    double force_N = 0.0;
    std::uint8_t flags = 0;  ///< DutFlag
  };
  Output step(std::uint16_t code);

  /// Smallest step of the output without compensation, N: G v_range / (2^bits - 1).
  double lsb_N() const { return gain_ * volt_; }
  std::int64_t code_max() const { return code_max_; }

 private:
  enum class Phase { rest, armed, cycling, held };
  struct Extreme {
    std::int64_t value = 0, at = 0;
  };

  double rate_per_s(double f_Hz) const;
  double ratio(double amplitude_N) const;
  static double factor(double b, double q, double age_s);
  double age_s(std::int64_t at) const { return at > onset_ ? static_cast<double>(at - onset_) * 1e-3 : 0.0; }
  void solve_ratio();
  void take_peak(std::size_t first_quarter);
  void arm(std::int64_t onset, bool rising);
  void open_window();
  void movement();
  void quiet();
  void turning();
  void turning_point(bool peak, Extreme extreme);
  void confirm();
  void observe(std::uint16_t code);
  void close_window();
  void floor_restart(std::int64_t value);
  void floor_push();
  void next_bucket();
  std::int64_t lowest_bin() const;
  void tick();

  double gain_, offset_, b_scale_, q_scale_, volt_;
  std::int64_t code_max_, hysteresis_, band_;

  std::int64_t i_ = -1, sum_ = 0;
  std::array<std::uint16_t, 8> last_{};
  Phase phase_ = Phase::rest;
  std::int64_t still_value_ = 0, still_since_ = 0;

  bool rising_ = true;
  Extreme extreme_;
  std::int64_t peaks_ = 0, troughs_ = 0, armed_trough_ = 0;
  std::int64_t first_turn_ = 0, seen_first_turn_ = 0, last_turn_ = 0, interval_ = 0, longest_ = 0;

  std::int64_t onset_ = 0, window_ = 0;
  bool open_ = false, known_ = false, slow_ = false;
  std::vector<std::int64_t> block_;  // reserved once
  std::int64_t block_sum_ = 0, block_n_ = 0;
  std::array<Extreme, 4> quarter_{};
  std::array<bool, 4> has_high_{}, has_low_{};
  std::array<std::int64_t, 4> quarter_low_{};

  std::array<std::int64_t, 12> bucket_{};
  std::int64_t bucket_number_ = 0, in_bucket_ = 0, floor_ = 0;
  std::size_t slot_ = 0;

  std::int64_t held_since_ = 0, exposure_ = 0;
  Extreme peak_;
  double peak_age_s_ = 0;
  std::int64_t trough_ = 0;
  double b_ = 0, q_ = 1;
  bool fast_ = false;
  double factor_ = 1.0, floor_V_ = 0.0;
};

}  // namespace forcegate
