// Contact force of a robot that follows a patient (Lebosse 2011, V-B: a force that is held, not a profile that is
// tracked): integral control as in force_integral with a zero at the pole of the sensor's lag (T = 60 ms, which gives the
// 210 ms to the final value of an FSR, III-B), and a limited speed of approach, so that a lost contact is sought gently,
//   v = clamp((K / k) (F_set - F_est - T dF_est/dt), -v_back, v_approach) / (e sin(theta)),   k the spring, e the wheel.
// The zero takes the sensor's lag out of the loop; what is left are the 10 ms period, the drive and the smoothing of the
// slope over 20 ms. K = 12 1/s leaves a phase margin of about 60 degrees there and lets through 13 % of a breath at
// 0.25 Hz; without the zero K = 6 1/s has the same margin and lets through 25 %. Approach 12 mm/s, retreat three times as
// fast: leaving is the safe direction.

#include <algorithm>

#include "hil/base/portable_math.h"
#include "hil/interface/controller.h"
#include "hil/rig/controllers/wheel_geometry.h"

namespace forcegate {
namespace {

constexpr double kForceGain_per_s = 12.0, kSensorLag_s = 0.06, kSmoothing_s = 0.02;
constexpr double kApproach_mm_per_s = 12.0, kRetreat_mm_per_s = 36.0;
constexpr double kLeastSine = 0.2;  // at the ends of its travel the wheel has no slope

class ContactForce final : public Controller {
 public:
  void reset(const RigGeometry& geometry) override {
    geometry_ = geometry;
    slope_N_per_s_ = 0.0;
    started_ = false;
  }
  double velocity_rad_per_s(const ControllerInput& in) override {
    const double slope = wheel_slope_max_N_per_rad(geometry_);
    if (!(slope > 0.0) || !(geometry_.eccentricity_mm > 0.0)) return 0.0;
    if (started_)
      slope_N_per_s_ += in.period_s / (in.period_s + kSmoothing_s) *
                        ((in.estimate_N - last_N_) / in.period_s - slope_N_per_s_);
    started_ = true;
    last_N_ = in.estimate_N;
    const double lever = std::max(kLeastSine, portable::sin(in.theta_rad));
    const double wanted_mm_per_s = kForceGain_per_s *
                                   (in.setpoint_N - in.estimate_N - kSensorLag_s * slope_N_per_s_) /
                                   geometry_.spring_N_per_mm;
    return std::clamp(wanted_mm_per_s, -kRetreat_mm_per_s, kApproach_mm_per_s) /
           (geometry_.eccentricity_mm * lever);
  }
  bool uses_estimate() const override { return true; }

 private:
  RigGeometry geometry_;
  double last_N_ = 0.0, slope_N_per_s_ = 0.0;
  bool started_ = false;
};

const Registration<ControllerKind> kRegistered{
    {"contact_force",
     "Holds a contact force on a moving body: integral control with the sensor's lag taken out and a limited speed of approach",
     [] { return std::unique_ptr<Controller>(std::make_unique<ContactForce>()); }}};

}  // namespace
}  // namespace forcegate
