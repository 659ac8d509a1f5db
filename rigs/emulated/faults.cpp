#include "rigs/emulated/faults.h"

#include "hil/base/text.h"

namespace forcegate::emulated {

bool Faults::touches_rows() const {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  return reference_frozen_s < kNever || sensor_unplugged_s < kNever || adc_stuck_bit >= 0 ||
         sample_loss > 0.0;
}

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kinds{
      {"adc_stuck_bit", "number of the converter bit that always reads 1", 0, 15,
       [](Faults& f, double m) { f.adc_stuck_bit = static_cast<int>(m); }},
      {"head_motion", "scale of the motion of a patient's head against the coil", 0, 3,
       [](Faults& f, double m) { f.head_motion = m; }},
      {"motor_stalled", "instant from which the shaft stands still, s", 0, 1e9,
       [](Faults& f, double m) { f.motor_stalled_s = m; }},
      {"reference_frozen", "instant from which the ATI repeats its reading, s", 0, 1e9,
       [](Faults& f, double m) { f.reference_frozen_s = m; }},
      {"reference_offset", "error added to the ATI reading, N", -20, 20,
       [](Faults& f, double m) { f.reference_offset_N = m; }},
      {"reference_saturated", "force at which the ATI overloads, N", 0, 20,
       [](Faults& f, double m) { f.reference_saturated_N = m; }},
      {"sample_loss", "share of the samples that never arrive", 0, 1,
       [](Faults& f, double m) { f.sample_loss = m; }},
      {"sensor_unplugged", "instant from which the sensor input is at 0 V, s", 0, 1e9,
       [](Faults& f, double m) { f.sensor_unplugged_s = m; }},
      {"transient", "number of attempts at a record that have the faults; later ones are sound", 1, 10,
       [](Faults&, double) {}},  // who plays a record again leaves them out
      {"truncated", "instant at which the record ends, s", 0, 1e9,
       [](Faults& f, double m) { f.truncated_s = m; }},
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
      return fail(ErrorCode::config, "the emulated rig has no fault '" + printable_utf8(name) + "'", {},
                  near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
    }
    if (!(magnitude >= kind->minimum && magnitude <= kind->maximum))
      return fail(
          ErrorCode::config, "fault " + name + " = " + shortest(magnitude) + " is out of range", {},
          "it is the " + kind->doc + ", from " + shortest(kind->minimum) + " to " + shortest(kind->maximum));
    kind->set(faults, magnitude);
  }
  return faults;
}

}  // namespace forcegate::emulated
