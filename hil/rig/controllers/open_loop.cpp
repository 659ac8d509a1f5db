// Open loop: the wheel plays the profile, whatever the sensor says. Once a period T
//   v = (theta(F_next) - theta(F_now)) / T + K (theta(F_now) - theta_measured),
// where theta(F) inverts the wheel's geometry. K = 30 1/s: with the drive's 8 ms and the 10 ms period the
// position error dies out without overshoot.

#include "hil/interface/controller.h"
#include "hil/rig/controllers/wheel_geometry.h"

namespace forcegate {
namespace {

constexpr double kPositionGain_per_s = 30.0;

class OpenLoop final : public Controller {
 public:
  void reset(const RigGeometry& geometry) override { geometry_ = geometry; }
  double velocity_rad_per_s(const ControllerInput& in) override {
    const double now = wheel_angle_rad(geometry_, in.setpoint_N);
    const double next = wheel_angle_rad(geometry_, in.setpoint_next_N);
    return (next - now) / in.period_s + kPositionGain_per_s * (now - in.theta_rad);
  }
  bool uses_estimate() const override { return false; }

 private:
  RigGeometry geometry_;
};

const Registration<ControllerKind> kRegistered{
    {"open_loop", "The wheel plays the profile by its geometry; the sensor is only listened to",
     [] { return std::unique_ptr<Controller>(std::make_unique<OpenLoop>()); }}};

}  // namespace
}  // namespace forcegate
