#include "hil/diagnose/refit/waterfall.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace forcegate::diagnose {

namespace {

// Mean over subsets with the Shapley weights; range over all subsets.
void average_over_orders(const std::vector<double>& error, std::size_t k, std::size_t n, Waterfall::Bar& bar) {
  bar.low = 1e300;
  bar.high = -1e300;
  bar.average = 0.0;
  for (unsigned s = 0; s < error.size(); ++s) {
    if ((s >> k & 1u) != 0) continue;
    const double fall = error[s] - error[s | 1u << k];
    double weight = 1.0 / static_cast<double>(n);
    for (int q = 0; q < std::popcount(s); ++q) weight *= static_cast<double>(q + 1) / static_cast<double>(static_cast<int>(n) - 1 - q);
    bar.average += weight * fall;
    bar.low = std::min(bar.low, fall);
    bar.high = std::max(bar.high, fall);
  }
  if (!std::isfinite(bar.average)) bar.low = bar.high = bar.average;  // an order that cannot be fitted
}

}  // namespace

Waterfall waterfall_of(const ErrorsOfEffects& errors) {
  Waterfall out;
  const std::size_t n = errors.effects.size();
  out.all_orders = errors.all_orders();
  const auto with_first = [&](std::size_t k) { return errors.error[out.all_orders ? (std::size_t{1} << k) - 1 : k]; };
  out.start = with_first(0);
  out.end = with_first(n);
  double now = out.start;
  for (std::size_t k = 0; k < n; ++k) {
    Waterfall::Bar bar;
    bar.effect = errors.effects[k];
    const double next = with_first(k + 1);
    bar.as_added = bar.average = bar.low = bar.high = now - next;
    if (std::isfinite(next)) now = next;
    if (out.all_orders) average_over_orders(errors.error, k, n, bar);
    bar.hollow = !(bar.low > 0.0);
    out.bars.push_back(bar);
  }
  return out;
}

}  // namespace forcegate::diagnose
