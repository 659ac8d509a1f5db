#pragma once
// Fewer points, same picture. M4 keeps first, minimum, maximum and last of every pixel column, so no peak is
// lost (Jugel et al. 2014); simplify_polyline drops points that lie on the line between their neighbours.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::figures {

/// Indices (ascending, unique) of first / min / max / last of `columns` equal intervals of x, united over all
/// of `y` (each as long as x). NaN values are skipped for min and max. x ascending.
std::vector<std::size_t> m4_indices(std::span<const double> x, std::span<const std::span<const double>> y,
                                    std::size_t columns);

struct Point {
  double x = 0.0, y = 0.0;
};

/// Ramer-Douglas-Peucker: every dropped point lies within `tolerance` of the kept polyline.
std::vector<Point> simplify_polyline(std::span<const Point> points, double tolerance);

}  // namespace forcegate::figures
