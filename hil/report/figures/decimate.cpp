#include "hil/report/figures/decimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace forcegate::figures {

std::vector<std::size_t> m4_indices(std::span<const double> x, std::span<const std::span<const double>> y,
                                    std::size_t columns) {
  std::vector<std::size_t> keep;
  const std::size_t n = x.size();
  if (n == 0 || columns == 0) return keep;
  const double low = x.front(), width = x.back() - x.front();
  const auto column_of = [&](std::size_t i) {
    if (!(width > 0.0)) return std::size_t{0};
    const double c = std::floor((x[i] - low) / width * static_cast<double>(columns));
    if (std::isnan(c)) return std::size_t{0};
    return static_cast<std::size_t>(std::clamp(c, 0.0, static_cast<double>(columns - 1)));
  };
  for (std::size_t begin = 0; begin < n;) {
    const std::size_t column = column_of(begin);
    std::size_t end = begin + 1;
    while (end < n && column_of(end) == column) ++end;
    keep.push_back(begin);
    keep.push_back(end - 1);
    for (const std::span<const double> channel : y) {
      std::size_t low_at = n, high_at = n;
      for (std::size_t i = begin; i < end; ++i) {
        if (std::isnan(channel[i])) continue;
        if (low_at == n || channel[i] < channel[low_at]) low_at = i;
        if (high_at == n || channel[i] > channel[high_at]) high_at = i;
      }
      if (low_at != n) {
        keep.push_back(low_at);
        keep.push_back(high_at);
      }
    }
    begin = end;
  }
  std::sort(keep.begin(), keep.end());
  keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
  return keep;
}

std::vector<Point> simplify_polyline(std::span<const Point> points, double tolerance) {
  if (points.size() < 3) return {points.begin(), points.end()};
  std::vector<char> keep(points.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    const Point a = points[first], b = points[last];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double length2 = dx * dx + dy * dy;
    double worst = tolerance * tolerance;
    std::size_t worst_at = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double px = points[i].x - a.x, py = points[i].y - a.y;
      const double along = length2 > 0.0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
      const double ex = px - along * dx, ey = py - along * dy;
      if (const double d2 = ex * ex + ey * ey; d2 > worst) {
        worst = d2;
        worst_at = i;
      }
    }
    if (worst_at == 0) continue;
    keep[worst_at] = 1;
    if (worst_at - first > 1) open.emplace_back(first, worst_at);
    if (last - worst_at > 1) open.emplace_back(worst_at, last);
  }
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (keep[i]) out.push_back(points[i]);
  return out;
}

}  // namespace forcegate::figures
