#pragma once
// Cycles that are narrower than a pixel, drawn as a line, are stripes that nothing in the data makes. What can be seen of them is how far they go.

#include <cstddef>
#include <string>
#include <vector>

#include "hil/report/figures/figure.h"

namespace forcegate::figures {

/// Smallest and largest of equal stretches of x; NaN where a stretch has no sample.
struct Envelope {
  std::vector<double> x, low, high;
};

/// `x` ascending and not empty; a y that is no number counts for none.
Envelope envelope(const std::vector<double>& x, const std::vector<double>& y, std::size_t stretches);

/// Gaps part the band.
void add_band(Panel& panel, const Envelope& e, Role role, double opacity, std::string label);

}  // namespace forcegate::figures
