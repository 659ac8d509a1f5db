#pragma once
// What the bench file says about every ATI reference, however it is connected.

#include <cstddef>
#include <string>

#include "hil/base/config_node.h"

namespace forcegate::ati {

struct ReferenceOptions {
  std::size_t axis = 2;  ///< 0, 1, 2: Fx, Fy, Fz
  double sign = 1.0;     ///< -1: pressing the sensor reads negative
  double resolution_N = 0.0, noise_N = 0.0;
  double force_max_N = 0.0;  ///< end of the calibrated range
  double jump_max_N = 2.0;   ///< from one record to the next; more is an unreadable record
  std::string serial, calibration_id;
};

/// The keys axis ("Fx", "Fy", "Fz"), sign (-1 or 1), resolution_N, noise_N, force_max_N, jump_max_N, serial and
/// calibration_id; resolution, range, serial and calibration are required. Keys of [reference] that are read elsewhere
/// (adapter, calibration_expires, u_rel) count as known. Errors come out of reader.finish().
void read_reference_options(ConfigReader& reader, ReferenceOptions& options);

}  // namespace forcegate::ati
