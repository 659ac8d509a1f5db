// Contact force of a robot that follows a patient (Lebosse 2011, V-B: a force that is held, not a profile that is
// tracked): integral control as in force_integral, but slow enough for a sensor that lags by 60 ms (FSR) and with a
// limited speed of approach, so that a lost contact is sought gently,
//   v = clamp((K / s(theta)) (F_set - F_estimate), -v_back, v_approach),   s = dF/dtheta = k e sin(theta).
// K = 6 1/s: phase margin about 65 degrees with that lag, the 10 ms period and the drive. Approach 12 mm/s, retreat three
// times as fast: leaving is the safe direction.

#include <algorithm>

#include "hil/base/portable_math.h"
#include "hil/interface/controller.h"
#include "hil/rig/controllers/wheel_geometry.h"

namespace forcegate {
namespace {

constexpr double kForceGain_per_s = 6.0, kApproach_mm_per_s = 12.0, kRetreat_mm_per_s = 36.0;
constexpr double kLeastSine = 0.2;  // at the ends of its travel the wheel has no slope

class ContactForce final : public Controller {
 public:
  void reset(const RigGeometry& geometry) override { geometry_ = geometry; }
  double velocity_rad_per_s(const ControllerInput& in) override {
    const double slope = wheel_slope_max_N_per_rad(geometry_);
    if (!(slope > 0.0) || !(geometry_.eccentricity_mm > 0.0)) return 0.0;
    const double lever = std::max(kLeastSine, portable::sin(in.theta_rad));
    const double wanted_mm_per_s = kForceGain_per_s * (in.setpoint_N - in.estimate_N) / geometry_.spring_N_per_mm;
    return std::clamp(wanted_mm_per_s, -kRetreat_mm_per_s, kApproach_mm_per_s) / (geometry_.eccentricity_mm * lever);
  }
  bool uses_estimate() const override { return true; }

 private:
  RigGeometry geometry_;
};

const Registration<ControllerKind> kRegistered{
    {"contact_force", "Holds a contact force on a moving body: slow integral control with a limited speed of approach",
     [] { return std::unique_ptr<Controller>(std::make_unique<ContactForce>()); }}};

}  // namespace
}  // namespace forcegate
