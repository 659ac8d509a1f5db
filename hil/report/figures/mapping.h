#pragma once
// From data to pixels: ranges of panels and the scale of one axis. Private to the figures library.

#include <algorithm>
#include <cmath>

#include "hil/report/figures/figure.h"

namespace forcegate::figures {

struct Range {
  double low = kAuto, high = kAuto;
  void include(double v) {
    if (!std::isfinite(v)) return;
    if (!(low <= v)) low = v;
    if (!(high >= v)) high = v;
  }
  bool known() const { return std::isfinite(low) && std::isfinite(high); }
};

struct PanelRange {
  Range x, y;
};

/// What the series of a panel cover, before padding.
PanelRange data_range(const Panel& panel);

/// The axis' own limits win; then padding (`margin` of the width on each side), zero, symmetry, and a width
/// when all data are equal.
Range finish_range(const Axis& axis, Range data, double margin);

/// One axis on `length` pixels; inverted = pixel 0 is the high end (y).
struct Mapping {
  Range range;
  Scale scale = Scale::linear;
  double length = 0.0;
  bool inverted = false;
  double linear_within = 1.0;  ///< of a symmetric_log scale

  double operator()(double v) const {
    double f;
    if (scale == Scale::logarithmic)
      f = v > 0.0 ? std::log(v / range.low) / std::log(range.high / range.low) : (std::isnan(v) ? v : -10.0);
    else if (scale == Scale::symmetric_log)
      f = (std::asinh(v / linear_within) - std::asinh(range.low / linear_within)) /
          (std::asinh(range.high / linear_within) - std::asinh(range.low / linear_within));
    else
      f = (v - range.low) / (range.high - range.low);
    return std::isnan(f)
               ? f
               : (inverted ? 1.0 - std::clamp(f, -10.0, 10.0) : std::clamp(f, -10.0, 10.0)) * length;
  }
};

}  // namespace forcegate::figures
