#pragma once

#include "hil/base/portable_math.h"

namespace forcegate::emulated {

/// Velocity-controlled DC motor: tau v' + v = v_cmd with |v_cmd| <= v_max, angle between two hard stops.
/// Integrated exactly for a command that is constant over one sample. Time constant and limit are ours,
/// chosen so that the bench's force step takes about 70 ms (Lebosse 2011, III-B).
class VelocityMotor {
 public:
  struct Parameters {
    double time_constant_s = 0.008;
    double velocity_max_rad_per_s = 40.0;
    double theta_min_rad = 0.0;
    double theta_max_rad = 3.14159265358979323846;
  };

  void begin(const Parameters& p, double step_s, double theta_rad) {
    p_ = p;
    step_s_ = step_s;
    keep_ = portable::exp(-step_s / p.time_constant_s);
    theta_ = theta_rad;
    velocity_ = command_ = 0.0;
    at_stop_ = stalled_ = false;
  }

  void command(double rad_per_s) {
    const double v = p_.velocity_max_rad_per_s;
    command_ = rad_per_s > v ? v : (rad_per_s < -v ? -v : rad_per_s);
  }
  void stall() { stalled_ = true; }

  double step() {
    if (stalled_) {
      velocity_ = 0.0;
      return theta_;
    }
    const double excess = velocity_ - command_;
    theta_ += command_ * step_s_ + excess * p_.time_constant_s * (1.0 - keep_);
    velocity_ = command_ + excess * keep_;
    at_stop_ = false;
    if (theta_ >= p_.theta_max_rad) hit(p_.theta_max_rad, command_ > 0.0);
    if (theta_ <= p_.theta_min_rad) hit(p_.theta_min_rad, command_ < 0.0);
    return theta_;
  }

  double theta_rad() const { return theta_; }
  double velocity_rad_per_s() const { return velocity_; }
  /// At an end of the travel and still pushed against it.
  bool at_stop() const { return at_stop_; }
  bool stalled() const { return stalled_; }
  /// Drive fault as a following error: a stalled shaft that is asked to move.
  bool following_error() const { return stalled_ && (command_ > 0.05 || command_ < -0.05); }

 private:
  void hit(double stop_rad, bool pushed) {
    theta_ = stop_rad;
    velocity_ = 0.0;
    at_stop_ = pushed;
  }

  Parameters p_;
  double step_s_ = 0.001, keep_ = 0.0;
  double theta_ = 0.0, velocity_ = 0.0, command_ = 0.0;
  bool at_stop_ = false, stalled_ = false;
};

}  // namespace forcegate::emulated
