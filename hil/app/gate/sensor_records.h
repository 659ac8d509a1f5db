#pragma once
// Records of a gate of conductance and capacitance as lines of JSON, for bundles. Numbers read back to the same bits.

#include <string>
#include <string_view>
#include <vector>

#include "hil/characterize/capacitance/weight_material.h"

namespace forcegate {

/// One line a record: {"sensor", "weights_N", "network_N", "conductance_N", "loading", "firmware_N", "flags", "accepted_N", "failure"}.
std::string to_text(const std::vector<characterize::SensorRecord>& records);

/// Inverse. Errors (parse): no JSON, lists of different lengths, a frame of no loading.
Result<std::vector<characterize::SensorRecord>> sensor_records_from(std::string_view text,
                                                                    const characterize::WeightGatePlan& plan,
                                                                    const std::string& name);

}  // namespace forcegate
