#pragma once

#include <functional>
#include <memory>
#include <string>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace forcegate {

/// What a controller may look at once a period.
struct ControllerInput {
  double t_s = 0.0;
  double period_s = 0.01;
  double setpoint_N = 0.0;       ///< at t
  double setpoint_next_N = 0.0;  ///< at t + period
  double estimate_N = 0.0;       ///< latest force by the firmware under test (closed loop)
  double theta_rad = 0.0;        ///< wheel angle read back
};

/// Turns set-point and estimate into a wheel velocity, rad/s.
class Controller {
 public:
  virtual ~Controller() = default;
  virtual void reset(const RigGeometry& geometry) = 0;
  virtual double velocity_rad_per_s(const ControllerInput& input) = 0;
  virtual bool uses_estimate() const = 0;
};

struct ControllerKind {
  std::string name;  ///< "open_loop", "force_integral"
  std::string doc;
  std::function<std::unique_ptr<Controller>()> make;
};

}  // namespace forcegate
