#pragma once
// A resistive sensor in a voltage divider: its conductance, which goes with the force, from the output, which does not.
//
//   above (sensor between supply and output, R between output and ground):  G = U / (R (V - U))
//   below (sensor between output and ground, R between supply and output):  G = (V - U) / (R U)

#include <optional>
#include <string>
#include <string_view>

#include "hil/trace/campaign.h"

namespace forcegate {

struct Divider {
  double R_ohm = 0.0;   ///< the fixed resistor, above 0
  double supply = 0.0;  ///< V in the unit of the output: volts, or counts of a converter whose reference is the supply (1024 for 10 bits); above 0
  bool sensor_below = false;
};

/// "10k:5", "10000:1024:below": ohms (k and M are known), supply, where the sensor is ("above" where nothing is said). Errors: usage.
Result<Divider> parse_divider(std::string_view word);

/// The output of every record becomes the conductance, siemens (a little below 0 where noise takes an unloaded one there); without a finite one (U at
/// the supply and beyond; below: U at 0) it is missing. A note of the campaign says so, and how many are missing. What the bench declares of its
/// converter in volts is forgotten. Errors (config): an output that is neither volts nor counts; (parse) more than a tenth of a record beyond 0 and V.
Result<void> read_divider(Campaign& campaign, const Divider& divider);

}  // namespace forcegate
