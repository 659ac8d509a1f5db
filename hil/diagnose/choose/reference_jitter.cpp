#include "hil/diagnose/choose/reference_jitter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/diagnose/base/judge.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kGroup = 5, kShortest = 20, kLongest = 100;  // rows
constexpr double kEnough = 20.0;    // groups
constexpr double kStill = 0.01;     // of the span
constexpr double kOfNoise = 5.0;    // what a stretch of noise spans, standard deviations

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double width() const { return std::max(0.0, high - low); }
};

struct Groups {
  double n = 0.0, fall = 0.0;
  void add(double of_group) { n += 1.0, fall += of_group; }
};

// End of the stretch from `from` on where the force stays within `width`, at most `longest` rows.
Index end_of_stretch(const VectorXd& force, Index from, Index longest, double width) {
  Range moved;
  Index to = from;
  for (; to < std::min(force.size(), from + longest); ++to) {
    moved.add(force[to]);
    if (moved.width() >= width) break;
  }
  return to;
}

// About the mean of the rows, as a sum of squares over them: unbiased for white noise.
double scatter(const VectorXd& e) {
  const auto n = static_cast<double>(e.size());
  return (e.array() - e.mean()).square().sum() * n / (n - 1.0);
}

// What goes with the force, as a sum of squares: beside a mean and a trend, for a creep and a servo both drift.
double with_force(const VectorXd& force, const VectorXd& e) {
  const VectorXd trend = VectorXd::LinSpaced(e.size(), -1.0, 1.0);
  const auto bent = [&](const VectorXd& x) {
    const VectorXd about = x.array() - x.mean();
    return VectorXd(about - trend * (trend.dot(about) / trend.squaredNorm()));
  };
  const VectorXd f = bent(force);
  const double ff = f.squaredNorm(), fe = f.dot(bent(e));
  return ff > 1e-24 ? fe * fe / ff : 0.0;
}

}  // namespace

double share_of_jitter(const ResidualChannel& channel, const MixedFit& before, const MixedFit& after, bool is_shift) {
  const auto without = residual_rows(channel, before), with = residual_rows(channel, after);
  Range span;
  for (const RecordRows& rows : channel.rows)
    for (Index i = 0; i < rows.matrix.rows(); ++i) span.add(rows.matrix(i, 0));  // column 0 is the force
  double all = 0.0, smoothed = 0.0;
  Groups any, long_still;
  for (std::size_t k = 0; k < without.size(); ++k) {
    const auto n = static_cast<Index>(without[k].size());
    const Eigen::Map<const VectorXd> b(without[k].data(), n), a(with[k].data(), n);
    const VectorXd force = channel.rows[k].matrix.col(0).head(n);
    const double still = std::max(kStill * span.width(), kOfNoise * std::sqrt(channel.problem.records[k].smoothed_variance));
    all += b.squaredNorm() - a.squaredNorm();
    for (Index i = 0; i + kGroup <= n; i += kGroup) {
      if (end_of_stretch(force, i, kGroup, still) != i + kGroup) continue;
      const double fall = scatter(b.segment(i, kGroup)) - scatter(a.segment(i, kGroup));
      any.add(fall);
      constexpr Index kLong = kShortest + kGroup + kShortest;
      if (i >= kShortest && end_of_stretch(force, i - kShortest, kLong, still) == i - kShortest + kLong) long_still.add(fall);
    }
    for (Index i = 0; i < n;) {
      const Index to = end_of_stretch(force, i, kLongest, still), rows = to - i;
      if (rows >= kShortest)
        smoothed += with_force(force.segment(i, rows), b.segment(i, rows)) - with_force(force.segment(i, rows), a.segment(i, rows));
      i = std::max(to, i + 1);
    }
  }
  // just behind an edge what is late goes on while the force stands already
  const bool has_rest = long_still.n >= (is_shift ? 1.0 : kEnough);
  const double white = has_rest ? long_still.fall * any.n / long_still.n : is_shift ? 0.0 : any.fall;
  return all > 0.0 ? std::max(white, smoothed) / all : 0.0;
}

}  // namespace forcegate::diagnose
