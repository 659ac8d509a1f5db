#include "adapters/ati/reference_options.h"

#include <array>
#include <cstdint>

namespace forcegate::ati {

void read_reference_options(ConfigReader& in, ReferenceOptions& o) {
  constexpr std::array<const char*, 3> kAxes{"Fx", "Fy", "Fz"};
  std::string axis = kAxes[o.axis];
  std::int64_t sign = o.sign < 0.0 ? -1 : 1;
  for (const char* elsewhere : {"adapter", "calibration_expires", "u_rel"}) in.any(elsewhere);
  in.choice("axis", axis, {"Fx", "Fy", "Fz"});
  if (in.integer("sign", sign, -1, 1) && sign == 0) in.complain(*in.any("sign"), "'sign' in [reference] = 0 is neither -1 nor 1", "-1: pressing the sensor reads negative");
  in.number("resolution_N", o.resolution_N, 1e-6, 10, ConfigReader::required);
  in.number("noise_N", o.noise_N, 0, 10);
  in.number("force_max_N", o.force_max_N, 0.1, 100000, ConfigReader::required);
  in.number("jump_max_N", o.jump_max_N, 0.01, 100000);
  in.text("serial", o.serial, ConfigReader::required);
  in.text("calibration_id", o.calibration_id, ConfigReader::required);
  o.sign = sign < 0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < kAxes.size(); ++i)
    if (axis == kAxes[i]) o.axis = i;
}

}  // namespace forcegate::ati
