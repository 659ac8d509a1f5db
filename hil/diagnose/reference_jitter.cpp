#include "hil/diagnose/reference_jitter.h"

#include <algorithm>
#include <limits>

#include "hil/diagnose/residual_map.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kGroup = 5;
constexpr double kStill = 0.01;

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double width() const { return std::max(0.0, high - low); }
};

// Scatter about the group's own mean, as a sum of squares over its rows: unbiased for white noise.
double scatter(const double* e) {
  constexpr double n = static_cast<double>(kGroup);
  double sum = 0.0, square = 0.0;
  for (std::size_t j = 0; j < kGroup; ++j) {
    sum += e[j];
    square += e[j] * e[j];
  }
  return (square - sum * sum / n) * n / (n - 1.0);
}

}  // namespace

double share_of_jitter(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after) {
  const auto without = residual_rows(channel, before), with = residual_rows(channel, after);
  Range span;
  for (const RecordRows& rows : channel.rows)
    for (Eigen::Index i = 0; i < rows.matrix.rows(); ++i) span.add(rows.matrix(i, 0));  // column 0 is the force
  double all = 0.0, jitter = 0.0;
  for (std::size_t k = 0; k < without.size(); ++k) {
    const std::vector<double>&b = without[k], &a = with[k];
    for (std::size_t i = 0; i < b.size(); ++i) all += b[i] * b[i] - a[i] * a[i];
    for (std::size_t i = 0; i + kGroup <= b.size(); i += kGroup) {
      Range moved;
      for (std::size_t j = i; j < i + kGroup; ++j) moved.add(channel.rows[k].matrix(static_cast<Eigen::Index>(j), 0));
      if (moved.width() < kStill * span.width()) jitter += scatter(&b[i]) - scatter(&a[i]);
    }
  }
  return all > 0.0 ? jitter / all : 0.0;
}

}  // namespace forcegate::diagnose
