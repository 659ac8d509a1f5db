#pragma once
// A small ideal bench for tests of the gate: the wheel is the force, the sensor is U = (F - F0) / G exactly,
// and the tests can spoil what they want.

#include <cmath>
#include <functional>
#include <limits>

#include "hil/interface/rig.h"

namespace forcegate::testing {

class FakeRig : public Rig {
 public:
  double gain_N_per_V = 0.5, offset_N = 0.1;
  double ends_after_s = std::numeric_limits<double>::infinity();
  /// Called for each sample after it was made: row, time, block.
  std::function<void(std::size_t row, double t_s, RigBlock& block)> spoil;
  int parked = 0;
  RigRecordRequest last_request;

  FakeRig() {
    info_.name = "fake";
    info_.version = "1";
    info_.can_move = true;
    info_.emulated = true;
    info_.reference_u_rel = 0.005;
    info_.geometry.eccentricity_mm = 10.0;
    info_.geometry.velocity_max_rad_per_s = 60.0;
  }
  RigInfo info() const override { return info_; }
  RigInfo& change_info() { return info_; }

  Result<void> begin(const RigRecordRequest& request) override {
    last_request = request;
    index_ = 0;
    velocity_ = 0.0;
    theta_ = std::acos(1.0 - request.force_low_N /
                                 (info_.geometry.spring_N_per_mm * info_.geometry.eccentricity_mm));
    return {};
  }
  Result<void> command_velocity(double rad_per_s) override {
    velocity_ = rad_per_s;
    return {};
  }
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    std::size_t done = 0;
    for (; done < n && static_cast<double>(index_) / info_.rate_Hz < ends_after_s; ++done, ++index_) {
      const std::size_t i = at + done;
      theta_ = std::fmin(std::fmax(theta_ + velocity_ / info_.rate_Hz, info_.geometry.theta_min_rad),
                         info_.geometry.theta_max_rad);
      out.t_s[i] = static_cast<double>(index_) / info_.rate_Hz;
      out.force_ref_N[i] = static_cast<float>(force_ref_N());
      const double code = (force_ref_N() - offset_N) / gain_N_per_V / info_.v_range_V * 65535.0;
      out.adc[i] = static_cast<std::uint16_t>(std::fmin(std::fmax(std::round(code), 0.0), 65535.0));
      out.theta_rad[i] = static_cast<float>(theta_);
      out.status[i] = theta_ >= info_.geometry.theta_max_rad ? kRigTravelStop : 0;
      if (spoil) spoil(i, out.t_s[i], out);
    }
    return done;
  }
  double theta_rad() const override { return theta_; }
  double force_ref_N() const override {
    return info_.geometry.spring_N_per_mm * info_.geometry.eccentricity_mm * (1.0 - std::cos(theta_));
  }
  void park() noexcept override { ++parked; }

 private:
  RigInfo info_;
  std::uint64_t index_ = 0;
  double velocity_ = 0.0, theta_ = 0.0;
};

}  // namespace forcegate::testing
