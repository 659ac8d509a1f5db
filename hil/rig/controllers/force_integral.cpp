// Integral force control on the firmware's estimate (Lebosse 2011, IV-B2): the wanted wheel angle is the
// integral of the force error,
//   theta_c(t) = theta(0) + (K / s_max) int (F_set - F_estimate) dt,   s_max = k e = largest dF/dtheta,
// and the velocity-controlled motor follows it: v = theta_c' + K_p (theta_c - theta_measured).
// K = 20 1/s: bandwidth 3 Hz, phase margin about 60 degrees with the 10 ms period, one period of computing
// and the drive's 8 ms; at 0.5 Hz the amplitude is 1.2 % short. No feed-forward and no anti-windup, as in the
// paper: when the wheel is at its stop "a positive error is cumulated". The windup is cut at kWindup_rad so
// that a record that was saturated for hours can still end.

#include <algorithm>

#include "hil/interface/controller.h"
#include "hil/rig/controllers/wheel_geometry.h"

namespace forcegate {
namespace {

constexpr double kForceGain_per_s = 20.0;
constexpr double kPositionGain_per_s = 30.0;
constexpr double kWindup_rad = 100.0;

class ForceIntegral final : public Controller {
 public:
  void reset(const RigGeometry& geometry) override {
    geometry_ = geometry;
    started_ = false;
  }
  double velocity_rad_per_s(const ControllerInput& in) override {
    if (!started_) wanted_rad_ = in.theta_rad;
    started_ = true;
    const double slope = wheel_slope_max_N_per_rad(geometry_);
    if (!(slope > 0.0)) return 0.0;
    const double rate = kForceGain_per_s * (in.setpoint_N - in.estimate_N) / slope;
    const double velocity = rate + kPositionGain_per_s * (wanted_rad_ - in.theta_rad);
    wanted_rad_ = std::clamp(wanted_rad_ + rate * in.period_s, -kWindup_rad, kWindup_rad);
    return velocity;
  }
  bool uses_estimate() const override { return true; }

 private:
  RigGeometry geometry_;
  double wanted_rad_ = 0.0;
  bool started_ = false;
};

const Registration<ControllerKind> kRegistered{
    {"force_integral", "Integral force control on the estimate of the firmware under test",
     [] { return std::unique_ptr<Controller>(std::make_unique<ForceIntegral>()); }}};

}  // namespace
}  // namespace forcegate
