#pragma once

#include <cmath>
#include <cstdint>

namespace forcegate {

/// Full swings of the wheel.
class SwingCounter {
 public:
  void begin(double theta_rad) { turn_rad_ = theta_rad, rising_ = true, turns_ = 0; }
  void see(double theta_rad) {
    if (rising_ == (theta_rad > turn_rad_)) {
      turn_rad_ = theta_rad;
    } else if (std::fabs(theta_rad - turn_rad_) > kSwing_rad) {
      rising_ = !rising_;
      turn_rad_ = theta_rad;
      ++turns_;
    }
  }
  std::uint64_t cycles() const { return (turns_ + 1) / 2; }

 private:
  static constexpr double kSwing_rad = 0.05;
  double turn_rad_ = 0.0;
  bool rising_ = true;
  std::uint64_t turns_ = 0;
};

}  // namespace forcegate
