#pragma once
// The recorded capacitance as a function of the reference force, for effects that act through it.

#include <optional>

#include "hil/model/record_input.h"

namespace forcegate {

/// C(F) = C0 + C1 x + C2 x^2, x = (F - lowest) / range of the campaign: the parabola through all recorded rows. The record's
/// own noise is not in it, as it would be in dC/dt.
struct CapacitanceCurve {
  double lowest_N = 0.0, range_N = 1.0;
  double C0_F = 0.0, C1_F = 0.0, C2_F = 0.0;
  double at_F(double force_N) const;
  double slope_F_per_N(double force_N) const;
};

/// Nothing without C_F, with fewer than 100 rows of it, or where it does not rise over the whole span (Paredes-Madrid et al.
/// 2010: it grows with the force): a capacitance that says nothing about the force.
std::optional<CapacitanceCurve> capacitance_curve(const CampaignInput& campaign);

}  // namespace forcegate
