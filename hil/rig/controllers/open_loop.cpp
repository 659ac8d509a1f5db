// Open loop: the wheel plays the profile, whatever the sensor says. Once a period T
//   v = (theta(F_next) - theta(F_now)) / T + K (theta_d - theta_measured),
// where theta(F) inverts the wheel's geometry and theta_d is the angle of the set-point one drive time
// constant (8 ms) ago: that is where a wheel driven by the first term is now, so that the second one only
// mends errors. K = 30 1/s: with the 10 ms period an error dies out without overshoot. A jump of the set-point begins one
// period early, for the wheel is to be there when the set-point is.

#include "hil/interface/controller.h"
#include "hil/rig/controllers/wheel_geometry.h"

namespace forcegate {
namespace {

constexpr double kPositionGain_per_s = 30.0;
constexpr double kDriveLag_s = 0.008;

class OpenLoop final : public Controller {
 public:
  void reset(const RigGeometry& geometry) override {
    geometry_ = geometry;
    started_ = false;
  }
  double velocity_rad_per_s(const ControllerInput& in) override {
    const double now = wheel_angle_rad(geometry_, in.setpoint_N);
    const double next = wheel_angle_rad(geometry_, in.setpoint_next_N);
    if (!started_) before_rad_ = now;
    started_ = true;
    const double lag = kDriveLag_s < in.period_s ? kDriveLag_s / in.period_s : 1.0;
    const double due = now + lag * (before_rad_ - now);
    before_rad_ = now;
    return (next - now) / in.period_s + kPositionGain_per_s * (due - in.theta_rad);
  }
  bool uses_estimate() const override { return false; }

 private:
  RigGeometry geometry_;
  double before_rad_ = 0.0;
  bool started_ = false;
};

const Registration<ControllerKind> kRegistered{
    {"open_loop", "The wheel plays the profile by its geometry; the sensor is only listened to",
     [] { return std::unique_ptr<Controller>(std::make_unique<OpenLoop>()); }}};

}  // namespace
}  // namespace forcegate
