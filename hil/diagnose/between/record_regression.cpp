#include "hil/diagnose/between/record_regression.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/rng.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kFewest = 4;
constexpr int kScatters = 24;
constexpr double kFactor = 3.0;  // one standard deviation of the prior of s

// Variances beside that of every record, as multiples of it.
struct Structure {
  double session, cyclic, prior;
};

using Choices = std::vector<std::pair<double, double>>;  // ratio, prior
const Choices kNone = {{0.0, 1.0}};

Choices session_ratios(const RecordSeries& series) {
  std::vector<int> distinct = series.session;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (distinct.size() < 2 || distinct.size() == series.session.size()) return kNone;
  return {{0.0, 0.4}, {1.0, 0.2}, {10.0, 0.2}, {100.0, 0.2}};
}

// A few records that are not cyclic are needed to tell that the cyclic ones scatter more.
Choices cyclic_ratios(const RecordSeries& series) {
  constexpr std::ptrdiff_t kFewestStatic = 3;
  const auto cyclic = std::count(series.cyclic.begin(), series.cyclic.end(), 1);
  const auto n = static_cast<std::ptrdiff_t>(series.cyclic.size());
  if (cyclic == 0 || n - cyclic < kFewestStatic) return kNone;
  return {{0.0, 0.4}, {10.0, 0.2}, {100.0, 0.2}, {1000.0, 0.2}};
}

std::vector<Structure> structures(const RecordSeries& series) {
  std::vector<Structure> out;
  for (const auto& [session, of_session] : session_ratios(series))
    for (const auto& [cyclic, of_cyclic] : cyclic_ratios(series)) out.push_back({session, cyclic, of_session * of_cyclic});
  return out;
}

MatrixXd covariance(const RecordSeries& series, double scatter, double session, double cyclic) {
  const Index n = series.value.size();
  const double s2 = scatter * scatter;
  MatrixXd out = MatrixXd::Zero(n, n);
  out.diagonal() = series.variance.array() + s2;
  if (cyclic > 0.0)
    for (Index a = 0; a < n; ++a)
      if (series.cyclic[static_cast<std::size_t>(a)] != 0) out(a, a) += cyclic * s2;
  if (session > 0.0)
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < n; ++b)
        if (series.session[static_cast<std::size_t>(a)] == series.session[static_cast<std::size_t>(b)]) out(a, b) += session * s2;
  return out;
}

struct Scatter {
  double s, log_prior;
};

// Values of s, even in ln s, from far below the spread of the values to beyond it.
std::vector<Scatter> scatters(const RecordSeries& series) {
  const VectorXd d = series.value.array() - series.value.mean();
  const double spread = std::sqrt(d.squaredNorm() / static_cast<double>(std::max<Index>(1, d.size() - 1)));
  const double low = std::max(series.typical_scatter / 12.0, spread / 40.0), high = std::max(2.0 * low, 2.0 * spread);
  std::vector<Scatter> out;
  for (int k = 0; k < kScatters; ++k) {
    const double s = low * std::pow(high / low, k / (kScatters - 1.0)), away = std::log(s / series.typical_scatter) / std::log(kFactor);
    out.push_back({s, -0.5 * away * away});
  }
  return out;
}

// ln of the variance of a record beside that of its measurement, all shares of it together: under the model without x a session may hold
// what x explains, and the scatter within sessions alone would not fall.
double log_variance(const RecordSeries& series, double scatter, const Structure& more) {
  const double cyclic = series.cyclic.empty() ? 0.0 : static_cast<double>(std::ranges::count(series.cyclic, 1)) / static_cast<double>(series.cyclic.size());
  return std::log(scatter * scatter * (1.0 + more.session + cyclic * more.cyclic));
}

double half_log_det(const MatrixXd& lower) { return lower.diagonal().array().log().sum(); }

class LogSum {
 public:
  void add(double x, double value = 0.0) {
    if (x > top_) {
      const double shrink = std::exp(top_ - x);
      sum_ *= shrink;
      moment_ *= shrink;
      top_ = x;
    }
    sum_ += std::exp(x - top_);
    moment_ += std::exp(x - top_) * value;
  }
  double log() const { return top_ + std::log(sum_); }
  double mean() const { return moment_ / sum_; }

 private:
  double top_ = -1e300, sum_ = 0.0, moment_ = 0.0;
};

struct Best {
  double log_evidence = -1e300, scatter = 0.0, session = 0.0, cyclic = 0.0, size = 0.0;
  MatrixXd covariance_of(const RecordSeries& series) const { return covariance(series, scatter, session, cyclic); }
  // of each record by itself; what a session shares does not make one of its records count less than another
  VectorXd weight_of(const RecordSeries& series) const { return covariance(series, scatter, 0.0, cyclic).diagonal().cwiseInverse(); }
};

// Errors of records predicted from the others under a covariance, mu flat: (P y)_i / P_ii.
VectorXd left_out_errors(const RecordSeries& series, const MatrixXd& C) {
  const Index n = series.value.size();
  const MatrixXd inverse = C.llt().solve(MatrixXd::Identity(n, n));
  const VectorXd ones = inverse.rowwise().sum();
  const MatrixXd P = inverse - ones * ones.transpose() / ones.sum();
  return (P * series.value).cwiseQuotient(P.diagonal());
}

// 1 for records of which the others say something under a predictor whose strengths are free: the only one of its mounting has a column, or the
// mean, to itself (leverage 1). 0 for all where that leaves less than half of them.
VectorXd told_by_others(const RecordPredictor& p) {
  constexpr double kAlone = 0.999, kMost = 0.5;
  const Index n = p.column.rows();
  VectorXd out = VectorXd::Ones(n);
  if (p.weight.maxCoeff() != p.weight.minCoeff()) return out;
  MatrixXd X(n, p.column.cols() + 1);
  X << VectorXd::Ones(n), p.column;
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
  const MatrixXd Q = qr.householderQ() * MatrixXd::Identity(n, qr.rank());
  for (Index i = 0; i < n; ++i)
    if (Q.row(i).squaredNorm() > kAlone) out[i] = 0.0;
  if (out.sum() < kMost * static_cast<double>(n)) out.setZero();
  return out;
}

// Series and predictors under one covariance, the mean projected out: cross products of [y, columns].
struct Whitened {
  double log_null = 0.0;
  MatrixXd S;
};

Whitened whiten(const RecordSeries& series, const MatrixXd& C, const MatrixXd& columns) {
  const Index n = series.value.size();
  const Eigen::LLT<MatrixXd> llt(C);
  MatrixXd B(n, columns.cols() + 2);
  B.col(0).setOnes();
  B.col(1) = series.value;
  B.rightCols(columns.cols()) = columns;
  llt.matrixL().solveInPlace(B);
  const MatrixXd Q = B.transpose() * B;
  Whitened out;
  out.S = Q.bottomRightCorner(Q.rows() - 1, Q.cols() - 1) -
          Q.col(0).tail(Q.rows() - 1) * Q.row(0).tail(Q.cols() - 1) / Q(0, 0);
  out.log_null = -half_log_det(MatrixXd(llt.matrixL())) - 0.5 * std::log(Q(0, 0)) - 0.5 * out.S(0, 0);
  return out;
}

double log_bayes(const MatrixXd& S, Index first, const VectorXd& weight, double size) {
  const Index k = weight.size();
  const VectorXd root = size * weight.cwiseSqrt();
  MatrixXd M = root.asDiagonal() * S.block(first, first, k, k) * root.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> llt(M);
  const VectorXd b = root.cwiseProduct(S.col(0).segment(first, k));
  return 0.5 * b.dot(llt.solve(b)) - half_log_det(MatrixXd(llt.matrixL()));
}

}  // namespace

double log_mean_exp(const std::vector<double>& x) {
  if (x.empty()) return -1e300;
  LogSum sum;
  for (double v : x) sum.add(v);
  return sum.log() - std::log(static_cast<double>(x.size()));
}

double joint_gain(const std::vector<double>& gains) {
  if (gains.size() == 1) return gains.front();
  std::vector<double> all = gains;
  all.push_back(std::accumulate(gains.begin(), gains.end(), 0.0));
  return log_mean_exp(all);
}

double normalise(RecordPredictor& p) {
  const double n = static_cast<double>(p.column.rows());
  double square = 0.0, largest = 0.0;
  for (Index j = 0; j < p.column.cols(); ++j) {
    const VectorXd d = p.column.col(j).array() - p.column.col(j).mean();
    square += p.weight[j] * d.squaredNorm() / n;
    largest = std::max(largest, p.column.col(j).cwiseAbs().maxCoeff());
  }
  if (!(square > 1e-16 * largest * largest)) return 0.0;
  const double factor = 1.0 / std::sqrt(square);
  p.column *= factor;
  return factor;
}

std::vector<RecordScore> score_predictors(const RecordSeries& series, const std::vector<RecordPredictor>& predictors,
                                          const std::vector<double>& sizes) {
  std::vector<RecordScore> out(predictors.size());
  const Index n = series.value.size();
  if (n < kFewest || predictors.empty()) return out;
  Index k = 0;
  std::vector<Index> first;
  for (const RecordPredictor& p : predictors) {
    first.push_back(k + 1);
    k += p.column.cols();
  }
  MatrixXd columns(n, k);
  for (std::size_t v = 0; v < predictors.size(); ++v) columns.middleCols(first[v] - 1, predictors[v].column.cols()) = predictors[v].column;

  LogSum null;
  Best best_null;
  std::vector<LogSum> with(predictors.size());
  std::vector<Best> best(predictors.size());
  for (const auto& [s, log_prior] : scatters(series))
    for (const Structure& more : structures(series)) {
      const Whitened white = whiten(series, covariance(series, s, more.session, more.cyclic), columns);
      const double prior = std::log(more.prior) + log_prior;
      const double spread = log_variance(series, s, more);
      null.add(white.log_null + prior, spread);
      if (white.log_null + prior > best_null.log_evidence) best_null = {white.log_null + prior, s, more.session, more.cyclic, 0.0};
      for (std::size_t v = 0; v < predictors.size(); ++v)
        for (const double size : sizes) {
          const double e = white.log_null + prior + log_bayes(white.S, first[v], predictors[v].weight, size);
          with[v].add(e, spread);
          if (e > best[v].log_evidence) best[v] = {e, s, more.session, more.cyclic, size};
        }
    }
  const VectorXd e0 = left_out_errors(series, best_null.covariance_of(series));
  for (std::size_t v = 0; v < predictors.size(); ++v) {
    const RecordPredictor& p = predictors[v];
    out[v].gain = with[v].log() - std::log(static_cast<double>(sizes.size())) - null.log();
    out[v].explained = 1.0 - std::exp(with[v].mean() - null.mean());
    const MatrixXd K = best[v].size * best[v].size * p.column * p.weight.asDiagonal() * p.column.transpose();
    const MatrixXd C = best[v].covariance_of(series);
    const VectorXd e1 = left_out_errors(series, C + K);
    const VectorXd told = best[v].weight_of(series).cwiseProduct(told_by_others(p));
    out[v].left_out = told.sum() > 0.0 ? told.dot(e1.cwiseAbs2()) / std::max(1e-300, told.dot(e0.cwiseAbs2())) : 1.0;
    const VectorXd ones = VectorXd::Ones(n);
    const Eigen::LLT<MatrixXd> llt(C + K);
    const double mean = ones.dot(llt.solve(series.value)) / ones.dot(llt.solve(ones));
    const VectorXd added = K * llt.solve(VectorXd(series.value.array() - mean));
    out[v].added = added.array() - added.mean();
  }
  return out;
}

namespace {

double log_prior(const RecordSeries& series, double session, double cyclic) {
  for (const Structure& s : structures(series))
    if (s.session == session && s.cyclic == cyclic) return std::log(s.prior);
  return -1e300;
}

// Orders and directions are those of the residuals that the likeliest model without predictors whitens; what they show is weighed under that
// model's covariance, and under those with no share of the sessions, of the cyclic records, or of either. A predictor leaves nothing to
// sessions that it explains: weighed as if it did, a course that fits five sessions perfectly stood beside the scatter within them.
class Exchangeable {
 public:
  explicit Exchangeable(const RecordQuestion& question) {
    const RecordSeries& series = question.series;
    const Index n = series.value.size();
    std::vector<Best> best;
    const auto best_of = [&](double session, double cyclic) -> Best& {
      for (Best& b : best)
        if (b.session == session && b.cyclic == cyclic) return b;
      return best.emplace_back(Best{-1e300, 0.0, session, cyclic, 0.0});
    };
    for (const auto& [s, log_prior_of_s] : scatters(series))
      for (const Structure& more : structures(series)) {
        const Whitened white = whiten(series, covariance(series, s, more.session, more.cyclic), MatrixXd(n, 0));
        const double e = white.log_null + std::log(more.prior) + log_prior_of_s;
        Best& of = best_of(more.session, more.cyclic);
        if (e > of.log_evidence) of = {e, s, more.session, more.cyclic, 0.0};
      }
    const Best likeliest = *std::ranges::max_element(best, {}, &Best::log_evidence);
    const Eigen::LLT<MatrixXd> llt(likeliest.covariance_of(series));
    const VectorXd one = llt.matrixL().solve(VectorXd::Ones(n));
    residual_ = without(one.normalized(), llt.matrixL().solve(series.value));
    for (const Best& b : best) {
      if ((b.session != 0.0 && b.session != likeliest.session) || (b.cyclic != 0.0 && b.cyclic != likeliest.cyclic)) continue;
      const MatrixXd half = llt.matrixL().solve(b.covariance_of(series));
      const Eigen::LLT<MatrixXd> own(MatrixXd(llt.matrixL().solve(half.transpose())));
      View view;
      view.map = own.matrixL().solve(MatrixXd::Identity(n, n));
      const VectorXd seen = view.map * one;
      view.one = seen.normalized();
      view.log_null = log_prior(series, b.session, b.cyclic) - half_log_det(MatrixXd(own.matrixL())) - std::log(seen.norm());
      for (const RecordPredictor& p : question.predictors) {
        MatrixXd X = view.map * MatrixXd(llt.matrixL().solve(p.column)) * p.weight.cwiseSqrt().asDiagonal();
        X -= view.one * (view.one.transpose() * X);
        const Eigen::JacobiSVD<MatrixXd> svd(X, Eigen::ComputeThinU);
        VectorXd lambda = svd.singularValues().cwiseAbs2();
        if (lambda.sum() > 0.0) lambda *= static_cast<double>(n - 1) / lambda.sum();
        view.direction.push_back(svd.matrixU());
        view.lambda.push_back(lambda);
      }
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
      for (std::size_t v = 0; v < view.direction.size(); ++v) {
        const VectorXd share = (view.direction[v].transpose() * r).cwiseAbs2() / square;
        for (const double ratio : kRatios) {
          double removed = 0.0, cost = 0.0;
          for (Index j = 0; j < share.size(); ++j) {
            const double a = ratio * view.lambda[v][j];
            removed += a / (1.0 + a) * share[j];
            cost += 0.5 * std::log1p(a);
          }
          with.add(log_null - cost - half * std::log(std::max(1e-12, 1.0 - removed)));
        }
      }
    }
    return with.log() - null.log() - std::log(static_cast<double>(std::size(kRatios) * views_.front().direction.size()));
  }

 private:
  static constexpr double kRatios[] = {1.0, 4.0, 16.0, 64.0};  // variance of the effect over that of the scatter

  // One covariance in the coordinates of the residuals.
  struct View {
    MatrixXd map;
    VectorXd one;
    double log_null = 0.0;
    std::vector<MatrixXd> direction;
    std::vector<VectorXd> lambda;
  };

  static VectorXd without(const VectorXd& one, const VectorXd& x) { return x - one * one.dot(x); }
  VectorXd residual_;
  std::vector<View> views_;
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
  if (questions.empty() || questions.front().series.value.size() < kFewest) return {};
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
