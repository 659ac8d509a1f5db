#pragma once
// Lost contact of a few samples: the output falls to what it shows without a sensor and comes back, while the force stays where it is.

#include <cstddef>
#include <span>
#include <vector>

#include "hil/diagnose/raw/range_ends.h"

namespace forcegate::diagnose {

struct Fall {
  std::size_t begin = 0, end = 0;  ///< samples
};

/// Visits of a record's lowest level (a band of `near_V`), V, in the order of time. Each goes down and up again by a twentieth of `range_V` and
/// more, which no movement of the force explains; one lasts two samples and more, and nothing else in the record is as low. Empty where a visit is
/// otherwise, or where they hold a twentieth of the samples: then the level is one of the sensor's own.
std::vector<Fall> falls_to_floor(std::span<const double> F_N, std::span<const double> U_V, const StepsOfOutput& steps, double near_V, double range_V);

}  // namespace forcegate::diagnose
