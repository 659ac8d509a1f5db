#pragma once
// What the watches of a record (hil/rig/rig_witness.h) share. Where a watch is a template, kSound says that somebody has looked
// through the block: no row of it has a status bit or a value that is not finite, so nobody need ask. Each keeps what it counts over a
// block in locals: members would be written back to memory at every sample.

#include <cmath>
#include <cstdint>

#include "hil/base/portable_math.h"
#include "hil/interface/rig.h"

namespace forcegate::witness {

/// The reference has no force for this row.
inline bool no_reference(float force_N, std::uint16_t status) {
  return !std::isfinite(force_N) || (status & (kRigReferenceSaturated | kRigReferenceFault)) != 0;
}

/// F = k (preload + e (1 - cos theta)), newtons.
inline double spring_force_N(const RigGeometry& g, double theta_rad) {
  return g.spring_N_per_mm * (g.preload_mm + g.eccentricity_mm * (1.0 - portable::cos(theta_rad)));
}

inline double last_code(const RigInfo& info) { return static_cast<double>((1u << info.adc_bits) - 1u); }

}  // namespace forcegate::witness
