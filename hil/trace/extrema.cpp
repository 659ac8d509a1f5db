#include "hil/trace/extrema.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace forcegate {

std::vector<Extremum> turning_points(std::span<const double> t_s, std::span<const double> value, double prominence) {
  std::vector<Extremum> out;
  TurningPoints turning(prominence);
  for (std::size_t i = 0; i < std::min(t_s.size(), value.size()); ++i)
    if (turning.push(t_s[i], value[i])) out.push_back(turning.last());
  return out;
}

RelativeError mean_relative_error(std::span<const double> actual, std::span<const double> expected,
                                  double floor) {
  assert(actual.size() == expected.size());
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RelativeError out;
  double sum = 0.0, sum_absolute = 0.0;
  std::size_t finite = 0;
  const auto relative = [&](std::size_t i) {
    return std::fabs(actual[i] - expected[i]) / std::fabs(expected[i]);
  };
  const auto usable = [&](std::size_t i) {
    return std::isfinite(actual[i]) && std::isfinite(expected[i]) && std::fabs(expected[i]) >= floor &&
           expected[i] != 0.0;
  };
  for (std::size_t i = 0; i < actual.size(); ++i) {
    if (!std::isfinite(actual[i]) || !std::isfinite(expected[i])) {
      ++out.not_finite;
      continue;
    }
    ++finite;
    sum_absolute += std::fabs(actual[i] - expected[i]);
    if (!usable(i)) {
      ++out.left_out;
      continue;
    }
    ++out.n;
    sum += relative(i);
    out.largest = std::max(out.largest, relative(i));
  }
  const auto n_finite = static_cast<double>(finite);
  out.mean_absolute = finite > 0 ? sum_absolute / n_finite : kNone;
  double squares_absolute = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i)
    if (const double off = std::fabs(actual[i] - expected[i]) - out.mean_absolute; std::isfinite(off)) squares_absolute += off * off;
  out.standard_error_absolute = finite > 1 ? std::sqrt(squares_absolute / (n_finite - 1.0) / n_finite) : kNone;
  if (out.n == 0) {
    out.mean = out.standard_error = out.largest = kNone;
    return out;
  }
  const double n = static_cast<double>(out.n);
  out.mean = sum / n;
  double squares = 0.0;
  for (std::size_t i = 0; i < actual.size(); ++i)
    if (usable(i)) squares += (relative(i) - out.mean) * (relative(i) - out.mean);
  out.standard_error = out.n > 1 ? std::sqrt(squares / (n - 1.0) / n) : kNone;
  return out;
}

}  // namespace forcegate
