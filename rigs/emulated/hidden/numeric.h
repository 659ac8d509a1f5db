#pragma once
// Small functions of the truth side that give the same bits on every machine.

#include <cmath>
#include <numbers>

#include "hil/base/portable_math.h"

namespace forcegate::hidden {

inline constexpr double kPi = std::numbers::pi;

/// arccos on [-1, 1] (clamped), absolute error < 3e-8 rad (Abramowitz and Stegun 4.4.46).
double arc_cosine(double x);

/// Hyperbolic tangent, relative error < 1e-14 for |x| > 1e-4, < 4e-12 below.
double hyperbolic_tangent(double x);

/// log(1 + e^x) without overflow.
double softplus(double x);

/// exp(-(t / tau)^beta), t >= 0: stretched exponential of Kohlrausch.
double stretched(double t_s, double tau_s, double beta);

/// Value at a fractional index, linear between samples, held beyond the ends.
template <class Column>
double interpolate(const Column& column, double index) {
  if (!(index > 0.0)) return column.front();
  const auto last = static_cast<double>(column.size() - 1);
  if (index >= last) return column.back();
  const auto i = static_cast<std::size_t>(index);
  const double w = index - static_cast<double>(i);
  return column[i] + w * (column[i + 1] - column[i]);
}

}  // namespace forcegate::hidden
