#include "hil/diagnose/between/record_chance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "hil/base/rng.h"
#include "hil/diagnose/between/record_scatter.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A structure at the scatter that suits it best.
struct Likely {
  RecordStructure of;
  double scatter = 0.0, log_evidence = -1e300;
  MatrixXd covariance_for(const RecordSeries& series) const { return covariance(series, scatter, of); }
};

std::vector<Likely> likely_structures(const RecordSeries& series) {
  std::vector<Likely> out;
  for (const RecordStructure& of : structures(series)) {
    Likely& best = out.emplace_back(Likely{of});
    for (const auto& [s, log_prior] : scatters(series)) {
      const double e = whiten(series, covariance(series, s, of), MatrixXd(series.value.size(), 0)).log_null + std::log(of.prior) + log_prior;
      if (e > best.log_evidence) best.log_evidence = e, best.scatter = s;
    }
  }
  return out;
}

// Orders and directions are those of the residuals that the likeliest model without predictors whitens; what they show is weighed under that
// model's covariance, and under those with no share of the sessions, of the cyclic records, or of either. A predictor leaves nothing to
// sessions that it explains: weighed as if it did, a course that fits five sessions perfectly stood beside the scatter within them.
class Exchangeable {
 public:
  explicit Exchangeable(const RecordQuestion& question) {
    const RecordSeries& series = question.series;
    const Index n = series.value.size();
    const std::vector<Likely> all = likely_structures(series);
    const Likely& likeliest = *std::ranges::max_element(all, {}, &Likely::log_evidence);
    const Eigen::LLT<MatrixXd> llt(likeliest.covariance_for(series));
    const VectorXd one = llt.matrixL().solve(VectorXd::Ones(n));
    residual_ = without(one.normalized(), llt.matrixL().solve(series.value));
    for (const Likely& other : all) {
      if ((other.of.session != 0.0 && other.of.session != likeliest.of.session) || (other.of.cyclic != 0.0 && other.of.cyclic != likeliest.of.cyclic)) continue;
      const MatrixXd half = llt.matrixL().solve(other.covariance_for(series));
      const Eigen::LLT<MatrixXd> own(MatrixXd(llt.matrixL().solve(half.transpose())));
      View view;
      view.map = own.matrixL().solve(MatrixXd::Identity(n, n));
      const VectorXd seen = view.map * one;
      view.one = seen.normalized();
      view.log_null = std::log(other.of.prior) - half_log_det(MatrixXd(own.matrixL())) - std::log(seen.norm());
      for (const RecordPredictor& p : question.predictors) {
        if (p.alone && !other.of.apart()) continue;
        MatrixXd X = view.map * MatrixXd(llt.matrixL().solve(p.column)) * p.weight.cwiseSqrt().asDiagonal();
        X -= view.one * (view.one.transpose() * X);
        view.add(p, X);
      }
      predictors_ = question.predictors.size();
      views_.push_back(std::move(view));
    }
  }

  const VectorXd& residual() const { return residual_; }

  double gain(const VectorXd& residual) const {
    LogSum with, null;
    for (const View& view : views_) {
      const VectorXd r = without(view.one, view.map * residual);
      const double square = r.squaredNorm(), half = 0.5 * static_cast<double>(r.size() - 1);
      if (!(square > 0.0)) return -1e300;
      const double log_null = view.log_null - half * std::log(square);
      null.add(log_null);
      const VectorXd along = view.directions.transpose() * r, share = along.cwiseAbs2() / square;
      for (const Asked& a : view.asked)
        for (Index k = 0; k < std::ssize(kRatios); ++k) {
          const double left = std::max(1e-12, 1.0 - view.removed.row(k).segment(a.first, a.count).dot(share.segment(a.first, a.count)));
          const double of_sign = a.positive ? log_one_sided(along[a.first] * std::sqrt(view.removed(k, a.first) * 2.0 * half / (square * left))) : 0.0;
          with.add(log_null - a.cost[static_cast<std::size_t>(k)] - half * std::log(left) + of_sign);
        }
    }
    return with.log() - null.log() - std::log(static_cast<double>(std::size(kRatios) * predictors_));
  }

 private:
  static constexpr double kRatios[] = {1.0, 4.0, 16.0, 64.0};  // variance of the effect over that of the scatter

  // A predictor: its directions among those of a view, and what its strengths cost at every ratio.
  struct Asked {
    Index first = 0, count = 0;
    bool positive = false;
    std::array<double, std::size(kRatios)> cost{};
  };

  // One covariance in the coordinates of the residuals.
  struct View {
    MatrixXd map;
    VectorXd one;
    double log_null = 0.0;
    MatrixXd directions, removed;  // n x all; ratios x all: the share that goes away along each
    std::vector<Asked> asked;

    void add(const RecordPredictor& p, const MatrixXd& X) {
      const Eigen::JacobiSVD<MatrixXd> svd(X, Eigen::ComputeThinU);
      VectorXd lambda = svd.singularValues().cwiseAbs2();
      if (lambda.sum() > 0.0) lambda *= static_cast<double>(X.rows() - 1) / lambda.sum();
      MatrixXd U = svd.matrixU();
      if (p.positive && U.col(0).dot(X.col(0)) < 0.0) U = -U;
      Asked a{directions.cols(), U.cols(), p.positive};
      directions.conservativeResize(X.rows(), a.first + a.count);
      directions.rightCols(a.count) = U;
      removed.conservativeResize(std::ssize(kRatios), a.first + a.count);
      for (Index k = 0; k < std::ssize(kRatios); ++k)
        for (Index j = 0; j < a.count; ++j) {
          const double ratio = kRatios[k] * lambda[j];
          removed(k, a.first + j) = ratio / (1.0 + ratio);
          a.cost[static_cast<std::size_t>(k)] += 0.5 * std::log1p(ratio);
        }
      asked.push_back(a);
    }
  };

  static VectorXd without(const VectorXd& one, const VectorXd& x) { return x - one * one.dot(x); }
  VectorXd residual_;
  std::vector<View> views_;
  std::size_t predictors_ = 0;
};

constexpr int kHits = 40;  // enough to tell

// Columns of random direction that stand to each other as those of E do.
MatrixXd turned(const MatrixXd& E, Rng& rng) {
  MatrixXd random(E.rows(), E.cols());
  for (Index j = 0; j < random.cols(); ++j)
    for (Index i = 0; i < random.rows(); ++i) random(i, j) = rng.normal();
  const Index k = E.cols();
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(random).householderQ() * MatrixXd::Identity(E.rows(), k);
  const Eigen::HouseholderQR<MatrixXd> own(E);
  return Q * MatrixXd(own.matrixQR().topRows(k).triangularView<Eigen::Upper>());
}

}  // namespace

RecordChance chance_of_records(const std::vector<RecordQuestion>& questions, int draws, std::uint64_t seed) {
  if (questions.empty() || questions.front().series.value.size() < kFewestRecords) return {};
  std::vector<Exchangeable> series;
  for (const RecordQuestion& q : questions)
    if (!q.predictors.empty()) series.emplace_back(q);
  if (series.empty()) return {};
  const Index n = questions.front().series.value.size();
  MatrixXd E(n, static_cast<Index>(series.size()));
  for (std::size_t k = 0; k < series.size(); ++k) E.col(static_cast<Index>(k)) = series[k].residual();
  const auto gain = [&](const MatrixXd& residuals) {
    std::vector<double> gains;
    for (std::size_t k = 0; k < series.size(); ++k) gains.push_back(series[k].gain(residuals.col(static_cast<Index>(k))));
    return joint_gain(gains);
  };
  constexpr double kSame = 1e-9, kClearly = 0.5;  // nats
  const double seen = gain(E);
  bool beaten = false;
  const auto share = [&](const auto& draw) {
    int hits = 0;
    for (int k = 0; k < draws; ++k) {
      const double g = gain(draw());
      beaten = beaten || g > seen + kClearly;
      if (g >= seen - kSame && ++hits == kHits) return hits / (1.0 + k);
    }
    return (1.0 + hits) / (1.0 + draws);
  };
  RecordChance out;
  Rng rng(seed, "records permuted");
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  out.of_orders = share([&] {
    for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[rng.below(i)]);
    return MatrixXd(E(order, Eigen::all));
  });
  out.of_directions = out.of_orders;
  if (beaten) return out;
  Rng directions(seed, "records turned");
  out.of_directions = share([&] { return turned(E, directions); });
  return out;
}

double bayes_factor_bound(double chance) {
  return chance < std::exp(-1.0) ? -1.0 / (std::exp(1.0) * chance * std::log(chance)) : 1.0;
}

}  // namespace forcegate::diagnose
