#pragma once
// What reference and drive said of late, read at the instants of the board's conversions.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "hil/interface/device.h"

namespace forcegate {

struct ForceAt {
  float force_N = 0.0f;      ///< NaN where no reading is near
  std::uint16_t status = 0;  ///< RigStatus bits of the readings that it lies between; kRigReferenceFault where none is near
  bool is_final = false;     ///< a reading behind the instant is among them
};

/// Linearly between the readings before and behind an instant; where one of them is farther away than `stale_s`, or has not come yet, the other
/// stands in for both. Not so a younger one for those that were dropped: before the oldest that is left no reading is near.
class PassedForces {
 public:
  /// Readings older than the youngest by `keep_s` are dropped.
  void begin(double keep_s);
  void take(const std::vector<ReferenceReading>& fresh);
  ForceAt at(double t_s, double stale_s) const;

 private:
  std::deque<ReferenceReading> readings_;
  double keep_s_ = 1.0;
  bool dropped_ = false;
};

/// The wheel's angle in rad, linearly between what the drive said; before the first and behind the last that one.
class PassedAngles {
 public:
  /// Angles older than the youngest by `keep_s` are dropped.
  void begin(double t_s, double theta_rad, double keep_s) { angles_.assign(1, {t_s, theta_rad}), keep_s_ = keep_s; }
  void take(double t_s, double theta_rad);
  double at(double t_s) const;

 private:
  std::deque<std::pair<double, double>> angles_ = {{0.0, 0.0}};
  double keep_s_ = 1.0;
};

}  // namespace forcegate
