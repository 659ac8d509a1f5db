#include "rigs/emulated/faults.h"

#include "hil/base/text.h"

namespace forcegate::emulated {

namespace {

constexpr const char* kTransient = "transient";  // says how long the others last

}  // namespace

bool Faults::touches_rows() const {
  return reference_frozen_s < kNever_s || reference_late_s > 0.0 || reference_stale > 0.0 ||
         sensor_unplugged_s < kNever_s || sensor_late_s > 0.0 || sensor_stale > 0.0 || adc_stuck_bit >= 0 ||
         sample_loss > 0.0 || clock_skew != 0.0 || clock_jump_s != 0.0;
}

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kinds{
      {"adc_stuck_bit", "number of the converter bit that always reads 1", 0, 15,
       [](Faults& f, double m) { f.adc_stuck_bit = static_cast<int>(m); }},
      {"clock_jump", "jump of the time stamps in mid-run, s", -1e4, 1e4,
       [](Faults& f, double m) { f.clock_jump_s = m; }},
      {"clock_skew", "relative error of the time stamps", -0.5, 0.5,
       [](Faults& f, double m) { f.clock_skew = m; }},
      {"head_motion", "motion of a patient's head against the coil; 1: 1 mm of breathing, leaps of 3 mm, and at times out of contact", 0, 3,
       [](Faults& f, double m) { f.head_motion = m; }},
      {"motor_backlash", "play between shaft and wheel, rad", 0, 1,
       [](Faults& f, double m) { f.motor_backlash_rad = m; }},
      {"motor_ripple", "amplitude of the ripple of the wheel angle, twelve a turn, rad", 0, 0.08,
       [](Faults& f, double m) { f.motor_ripple_rad = m; }},
      {"motor_stalled", "instant from which the shaft stands still, s", 0, 1e9,
       [](Faults& f, double m) { f.motor_stalled_s = m; }},
      {"preload_wrong", "preload beyond what the geometry says, mm", -10, 10,
       [](Faults& f, double m) { f.preload_wrong_mm = m; }},
      {"reference_drift", "drift of the ATI reading, N/min", -20, 20,
       [](Faults& f, double m) { f.reference_drift_N_per_min = m; }},
      {"reference_frozen", "instant from which the ATI repeats its reading, s", 0, 1e9,
       [](Faults& f, double m) { f.reference_frozen_s = m; }},
      {"reference_gain", "factor on the ATI reading that nobody is told of", 0.01, 100,
       [](Faults& f, double m) { f.reference_gain = m; }},
      {"reference_late", "delay of the ATI reading, s", 0, 1,
       [](Faults& f, double m) { f.reference_late_s = m; }},
      {"reference_offset", "error added to the ATI reading, N", -20, 20,
       [](Faults& f, double m) { f.reference_offset_N = m; }},
      {"reference_saturated", "force at which the ATI overloads, N", 0, 20,
       [](Faults& f, double m) { f.reference_saturated_N = m; }},
      {"reference_stale", "share of 100-ms stretches in which the ATI repeats its reading", 0, 1,
       [](Faults& f, double m) { f.reference_stale = m; }},
      {"reference_swapped", "share of the force that the axis read out by mistake sees", -1, 0.9,
       [](Faults& f, double m) { f.reference_axis_share = m; }},
      {"sample_loss", "share of the samples that never arrive", 0, 1,
       [](Faults& f, double m) { f.sample_loss = m; }},
      {"sensor_late", "delay of the sensor's codes, s", 0, 1,
       [](Faults& f, double m) { f.sensor_late_s = m; }},
      {"sensor_stale", "share of 100-ms stretches in which the sensor's code repeats", 0, 1,
       [](Faults& f, double m) { f.sensor_stale = m; }},
      {"sensor_unplugged", "instant from which the sensor input is at 0 V, s", 0, 1e9,
       [](Faults& f, double m) { f.sensor_unplugged_s = m; }},
      {"specimen_swapped", "signal of the mounted specimen over that of the calibrated one", 0.01, 100,
       [](Faults& f, double m) { f.sensor_gain = m; }},
      {"spring_slipped", "preload lost in mid-run, mm", 0, 20,
       [](Faults& f, double m) { f.spring_slipped_mm = m; }},
      {"spring_stiffness", "factor on the stiffness of the spring", 0.1, 10,
       [](Faults& f, double m) { f.spring_stiffness = m; }},
      {kTransient, "number of attempts at a record that have the faults; later ones are sound", 1, 10,
       [](Faults&, double) {}},  // who plays a record again leaves them out
      {"truncated", "instant at which the record ends, s", 0, 1e9,
       [](Faults& f, double m) { f.truncated_s = m; }},
      {"wrong_calibration", "factor on the ATI reading: the calibration of another transducer is loaded",
       0.01, 100,
       [](Faults& f, double m) {
         f.reference_gain = m;
         f.reference_foreign_calibration = true;
       }},
  };
  return kinds;
}

Result<Faults> parse_faults(const std::map<std::string, double>& by_name) {
  Faults faults;
  for (const auto& [name, magnitude] : by_name) {
    const FaultKind* kind = nullptr;
    std::vector<std::string> names;
    for (const FaultKind& k : fault_kinds()) {
      names.push_back(k.name);
      if (k.name == name) kind = &k;
    }
    if (kind == nullptr) {
      const std::string near = nearest_name(name, names);
      return fail(ErrorCode::config, "the emulated rig has no fault '" + printable_utf8(name) + "'", "rig emulated",
                  near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
    }
    if (!(magnitude >= kind->minimum && magnitude <= kind->maximum))
      return fail(
          ErrorCode::config, "fault " + name + " = " + shortest(magnitude) + " is out of range", "rig emulated",
          "it is the " + kind->doc + ", from " + shortest(kind->minimum) + " to " + shortest(kind->maximum));
    Faults alone;
    kind->set(alone, magnitude);
    if (alone == Faults{} && name != kTransient)
      return fail(ErrorCode::config, "fault " + name + " = " + shortest(magnitude) + " changes nothing: the rig would be sound", "rig emulated",
                  "it is the " + kind->doc + "; give another magnitude, or leave the fault out");
    kind->set(faults, magnitude);
  }
  return faults;
}

}  // namespace forcegate::emulated
