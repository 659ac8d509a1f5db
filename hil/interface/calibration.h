#pragma once

#include <string>
#include <string_view>

namespace forcegate {

/// How much of the specimen the compensation has been told (docs/gate.md, 1).
enum class CalibrationLevel {
  nominal,     ///< the paper's values for the sensor type
  statical,    ///< G and F0 of this specimen and session measured by two slow sweeps (eq. 1)
  identified,  ///< b and q = c/a too, from an earlier dynamic record of this specimen
};

std::string_view to_string(CalibrationLevel level);  ///< "nominal", "static", "identified"

/// What the harness tells the firmware before any sample counts (frame PARAM CAL).
/// F = gain_N_per_V * U + offset_N (Lebosse 2011, eq. 1); decay rate b_scale * (0.0019 f + 0.0056) 1/s and
/// ratio q = c/a = q_scale / (1 + 1.377 A^2) (eq. 5). adc code n means U = n / (2^adc_bits - 1) * v_range_V.
struct Calibration {
  double gain_N_per_V = 0.5;
  double offset_N = 0.0;
  int adc_bits = 16;
  double v_range_V = 10.0;
  double b_scale = 1.0;
  double q_scale = 1.0;
  CalibrationLevel level = CalibrationLevel::nominal;
  std::string id = "nominal";  ///< at most 16 printable ASCII characters
};

}  // namespace forcegate
