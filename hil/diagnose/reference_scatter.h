#pragma once
// Scatter of the reference on quiet stretches, coloured noise included, which differences of neighbours do not see.

#include <span>

namespace forcegate::diagnose {

/// Lower quartile over windows of 0.25 s of the standard deviation of F about a parabola, less what U shows too (a force
/// that really moves moves the output). Newtons; 0 when there are fewer than eight windows.
double reference_scatter_N(std::span<const double> t_s, std::span<const double> F_N,
                           std::span<const double> U_V);

}  // namespace forcegate::diagnose
