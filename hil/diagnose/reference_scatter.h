#pragma once
// Scatter of the reference beside the output, coloured noise included, which differences of neighbours do not see.

#include <cstddef>
#include <span>

namespace forcegate::diagnose {

/// Standard deviations of F about a parabola over short windows, less what U shows too (a force that really moves moves the output), N.
struct ReferenceScatter {
  double quartile_N = 0.0;  ///< lower quartile over windows of 0.25 s in which F keeps to a tenth of its span; 0: fewer than eight of them
  double still_N = 0.0;  ///< RMS over the windows of 0.5 s in which U stands still, the highest 5 % left out: bursts count; 0: fewer than ten
};
/// `U_range_V`: span of U over the campaign. U stands still where its standard deviation is below 1 % of it.
ReferenceScatter reference_scatter(std::span<const double> t_s, std::span<const double> F_N, std::span<const double> U_V, double U_range_V);

}  // namespace forcegate::diagnose
