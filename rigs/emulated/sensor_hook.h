#pragma once
// A sensor with something that the starting model lacks: a hook between the contact force and the film. The
// reference cell feels the force itself. Chosen by the rig option hidden=NAME:STRENGTH, e.g.
// hidden=hysteresis:medium.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "hil/base/registry.h"
#include "hil/base/result.h"

namespace forcegate::emulated {

class SensorHook {
 public:
  virtual ~SensorHook() = default;

  /// The film has carried `force_N` for a moment after a rest without load.
  virtual void begin(double step_s, double force_N) = 0;
  /// Samples in order: force on the contact in, force that the film answers to out.
  virtual void feel(std::size_t n, const double* force_N, double* film_N) = 0;
  /// Every 10 ms, after the samples of that time.
  virtual void tick(double dt_s) = 0;
};

struct SensorHookKind {
  std::string name;
  std::string doc;
  double medium = 0.0;  ///< strength called medium; weak is 0.4 and strong 2.5 of it
  std::function<std::unique_ptr<SensorHook>(double strength)> make;
};

/// "hysteresis:medium", "creep:0.08" (share of the load), "hysteresis" (medium); null of "none". Errors: config, with the
/// names.
Result<std::unique_ptr<SensorHook>> make_sensor_hook(const std::string& text);

/// The same with the strength as a share: "creep:0.2" of "creep:strong"; "none" of "none".
Result<std::string> resolved_sensor_hook(const std::string& text);

/// What a sensor hides must not be read in a file: masked as the sheet of a mystery is. unsealed_sensor_hook() gives other texts as they are; errors: config,
/// where one was changed after it was sealed.
std::string sealed_sensor_hook(const std::string& resolved);
Result<std::string> unsealed_sensor_hook(const std::string& text);

}  // namespace forcegate::emulated
