#include "hil/diagnose/raw/range_ends.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

constexpr double kUnderWay = 0.5;  // of the step

}  // namespace

RangeEnds ends_of_range(std::span<const double> U, double low_V, double high_V, double lsb_V, double noise_V) {
  constexpr int kEnough = 4;
  const double margin = std::max(1.5 * lsb_V, 3.0 * noise_V);
  int at_low = 0, at_high = 0, beyond_low = 0, beyond_high = 0;
  for (const double u : U) {
    at_low += u <= low_V + 0.5 * lsb_V ? 1 : 0;
    beyond_low += u < low_V - lsb_V ? 1 : 0;
    at_high += u >= high_V - 1.5 * lsb_V ? 1 : 0;
    beyond_high += u > high_V + lsb_V ? 1 : 0;
  }
  RangeEnds ends;
  if (at_low >= kEnough && beyond_low == 0) ends.low_V = low_V + margin;
  if (std::isfinite(high_V) && at_high >= kEnough && beyond_high == 0) ends.high_V = high_V - margin;
  return ends;
}

Spread spread_of_present(std::span<const double> x) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double v : x) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  return low <= high ? Spread{low, high} : Spread{high, low};
}

bool StepsOfOutput::calm_before(std::size_t i) const {
  return i >= 2 && std::abs(U_[i - 2] - U_[i - 1]) < kUnderWay * std::abs(U_[i - 1] - U_[i]);
}

bool StepsOfOutput::calm_behind(std::size_t end, double from_V) const {
  return end + 1 < U_.size() && std::abs(U_[end + 1] - U_[end]) < kUnderWay * std::abs(U_[end] - from_V);
}

bool StepsOfOutput::falls_at(std::size_t i) const {
  if (i < 2 || !std::isfinite(U_[i - 1]) || !calm_before(i)) return false;
  const auto [low, high] = spread_of_present(F_.subspan(i - 2, 3));
  return exceeds(std::abs(U_[i - 1] - U_[i]), high - low);
}

}  // namespace forcegate::diagnose
