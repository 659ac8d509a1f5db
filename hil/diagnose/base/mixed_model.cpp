#include "hil/diagnose/base/mixed_model.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/record_part.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd expand_variance(const MixedProblem& problem, const VectorXd& variance) {
  VectorXd out(problem.nz);
  for (int j = 0; j < problem.nz; ++j) out[j] = variance[problem.component_of_z[j]];
  return out;
}

// Of a record's own zeta. Of one outside the fit the fixed parts are known no better than the fit knows them; one whose spread is held has no
// room for that either.
VectorXd own_variance(const MixedProblem& problem, const MixedFit& fit, const RecordGram& record) {
  VectorXd out = expand_variance(problem, fit.variance);
  if (fit.counts(record)) return out;
  for (int j = 0; j < problem.n_fixed; ++j)
    if (out[j] > kHeldVariance) out[j] += std::max(0.0, fit.covariance(j, j));
  return out;
}

VectorXd prior_precision(const MixedProblem& problem, const std::vector<int>& columns) {
  VectorXd out(problem.n_fixed + static_cast<Index>(columns.size()));
  for (int j = 0; j < problem.n_fixed; ++j)
    out[j] = 1.0 / (problem.fixed_prior_sd[j] * problem.fixed_prior_sd[j]);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double sd = problem.column_prior_sd[columns[k]];
    out[problem.n_fixed + static_cast<Index>(k)] = 1.0 / (sd * sd);
  }
  return out;
}

VectorXd prior_mean(const MixedProblem& problem, const std::vector<int>& columns) {
  VectorXd out = VectorXd::Zero(problem.n_fixed + static_cast<Index>(columns.size()));
  if (problem.column_prior_mean.size() == 0) return out;
  for (std::size_t k = 0; k < columns.size(); ++k) out[problem.n_fixed + static_cast<Index>(k)] = problem.column_prior_mean[columns[k]];
  return out;
}

VectorXd with_minus(const VectorXd& coefficient) {
  VectorXd v(coefficient.size() + 1);
  v.head(coefficient.size()) = -coefficient;
  v[coefficient.size()] = 1.0;
  return v;
}

// Slope of every column of S that grows with the gain on Z_0, over all records, beside a zero of each; 0 of others.
VectorXd slopes_on_gain(const MixedProblem& problem, const std::vector<int>& columns) {
  VectorXd out = VectorXd::Zero(std::ssize(columns));
  double WW = 0.0;
  for (const RecordGram& record : problem.records) {
    const MatrixXd& G = record.gram;
    const double per_one = G(1, 1) > 0.0 ? G(0, 1) / G(1, 1) : 0.0;
    WW += G(0, 0) - per_one * G(0, 1);
    for (std::size_t b = 0; b < columns.size(); ++b)
      if (const int j = problem.nz + columns[b]; problem.grows_with_gain[static_cast<std::size_t>(columns[b])] == GrowsWithGain::with_it)
        out[static_cast<Index>(b)] += G(0, j) - per_one * G(1, j);
  }
  return WW > 0.0 ? VectorXd(out / WW) : VectorXd::Zero(out.size());
}

// The part of the output that grows with the gain, at `coefficient`, in units of its own slope on Z_0; less Z_0 itself.
VectorXd per_gain_of(const MixedProblem& problem, const std::vector<int>& columns, const VectorXd& slopes, const VectorXd& coefficient) {
  constexpr double kLeast = 0.2;  // below it there is no output that anything could grow with
  const double gain = coefficient[0] + slopes.dot(coefficient.tail(slopes.size()));
  if (!(gain > kLeast)) return {};
  VectorXd out = VectorXd::Zero(coefficient.size());
  out[0] = coefficient[0] / gain - 1.0;
  for (std::size_t b = 0; b < columns.size(); ++b)
    if (problem.grows_with_gain[static_cast<std::size_t>(columns[b])] == GrowsWithGain::with_it) {
      const Index at = problem.n_fixed + static_cast<Index>(b);
      out[at] = coefficient[at] / gain;
    }
  return out;
}

// Of another fit of the problem, which may have other columns: 0 where it has not.
VectorXd coefficients_in(const MixedProblem& problem, const std::vector<int>& columns, const MixedFit& other) {
  VectorXd out(problem.n_fixed + std::ssize(columns));
  out << other.coefficient.head(problem.n_fixed), other.strengths_of(columns);
  return out;
}

// ln det of the factor: half the logarithm of the determinant.
double log_diagonal(const Eigen::LLT<MatrixXd>& llt) {
  double out = 0.0;
  for (Index j = 0; j < llt.rows(); ++j) out += std::log(llt.matrixL()(j, j));
  return out;
}

// Of the coefficients and of the variances, up to a constant.
double log_prior(const MixedProblem& problem, const MixedFit& fit, const VectorXd& precision, const VectorXd& mean) {
  double out = 0.5 * precision.array().log().sum() -
               0.5 * (fit.coefficient - mean).cwiseAbs2().cwiseProduct(precision).sum();
  for (std::size_t k = 0; k < problem.components.size(); ++k) {
    const VarianceComponent& c = problem.components[k];
    const double variance = fit.variance[static_cast<Index>(k)];
    out -= 0.5 * c.prior_weight * (std::log(variance) + c.prior_sd * c.prior_sd / variance);
  }
  return out;
}

// The M step of EM.
void update_variances(const MixedProblem& problem, const std::vector<Conditional>& conditional,
                      MixedFit& fit) {
  VectorXd sum = VectorXd::Zero(fit.variance.size()), count = sum;
  double own_gains = 0.0, with_gain = 0.0;
  for (std::size_t i = 0; i < conditional.size(); ++i) {
    const RecordGram& record = problem.records[i];
    const Conditional& c = conditional[i];
    fit.s2[i] = std::max(c.mean_square + c.trace, record.noise_variance);
    if (!fit.counts(record)) continue;
    for (int j = 0; j < problem.nz; ++j) {
      if (record.gram(j, j) < 1e-14) continue;  // the record does not excite this column
      const int k = problem.component_of_z[j];
      sum[k] += c.zeta[j] * c.zeta[j] + c.zeta_variance[j];
      count[k] += 1.0;
      if (j == 0) own_gains += c.zeta[j], with_gain += 1.0;
    }
  }
  // Gains that are all higher, beside strengths that are all smaller, are the same fit at a lower price of the strengths' priors: it is no spread.
  if (fit.per_gain.size() > 0 && with_gain > 0.0) sum[problem.component_of_z[0]] -= own_gains * own_gains / with_gain;
  for (Index k = 0; k < fit.variance.size(); ++k) {
    const VarianceComponent& c = problem.components[static_cast<std::size_t>(k)];
    fit.variance[k] = (c.prior_weight * c.prior_sd * c.prior_sd + sum[k]) / (c.prior_weight + count[k]);
  }
}

}  // namespace

VectorXd MixedFit::strengths_of(const std::vector<int>& of) const {
  VectorXd out(std::ssize(of));
  for (std::size_t a = 0; a < of.size(); ++a) out[static_cast<Index>(a)] = strength_of(of[a]);
  return out;
}

MixedFit fit_mixed(const MixedProblem& problem, const std::vector<int>& columns, const MixedFit* warm,
                   int iterations, RecordUse use) {
  const std::size_t n_records = problem.records.size();
  const Index d = problem.n_fixed + static_cast<Index>(columns.size());
  MixedFit fit;
  fit.columns = columns;
  fit.use = use;
  if (n_records == 0) return fit;
  std::vector<RecordPart> parts;
  parts.reserve(n_records);
  for (std::size_t i = 0; i < n_records; ++i) parts.emplace_back(problem, i, columns);

  const auto n_components = static_cast<Index>(problem.components.size());
  if (warm != nullptr && warm->valid) {
    fit.variance = warm->variance;
    fit.s2 = warm->s2;
  } else {
    fit.variance.resize(n_components);
    for (Index k = 0; k < n_components; ++k)
      fit.variance[k] = problem.components[k].start_sd * problem.components[k].start_sd;
    fit.s2.clear();
    for (const RecordGram& record : problem.records) fit.s2.push_back(std::max(record.noise_variance, 1e-6));
  }

  const VectorXd prior = prior_precision(problem, columns), mean = prior_mean(problem, columns), pull = prior.cwiseProduct(mean);
  std::vector<Conditional> conditional(n_records);
  const bool grows = !problem.grows_with_gain.empty();
  const VectorXd slopes = grows ? slopes_on_gain(problem, columns) : VectorXd();
  if (grows && warm != nullptr && warm->valid) fit.per_gain = per_gain_of(problem, columns, slopes, coefficients_in(problem, columns, *warm));
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const bool last = iteration + 1 == iterations;
    const VectorXd sigma2 = expand_variance(problem, fit.variance);
    MatrixXd M = MatrixXd::Zero(parts.front().rows_of_marginal(), d + 1);
    for (std::size_t i = 0; i < n_records; ++i) {
      parts[i].set_own_gain(fit.per_gain);
      parts[i].eliminate(sigma2, problem.records[i].n_eff / fit.s2[i]);
      if (fit.counts(problem.records[i])) parts[i].add_marginal(M);
    }
    MatrixXd P = M.topLeftCorner(d, d);
    P.diagonal() += prior;
    const Eigen::LLT<MatrixXd> llt(P);
    if (llt.info() != Eigen::Success) return fit;
    fit.coefficient = llt.solve(M.row(d).head(d).transpose() + pull);
    const VectorXd v = with_minus(fit.coefficient);
    for (std::size_t i = 0; i < n_records; ++i) parts[i].condition(v, conditional[i]);
    if (last) {
      fit.covariance = llt.solve(MatrixXd::Identity(d, d));
      for (std::size_t i = 0; i < n_records; ++i) {
        if (fit.counts(problem.records[i])) continue;
        parts[i].eliminate(own_variance(problem, fit, problem.records[i]), problem.records[i].n_eff / fit.s2[i]);
        parts[i].condition(v, conditional[i]);
      }
      fit.log_evidence = log_prior(problem, fit, prior, mean) - log_diagonal(llt);
      for (std::size_t i = 0; i < n_records; ++i)
        if (fit.counts(problem.records[i]))
          fit.log_evidence -= 0.5 * (problem.records[i].n_eff *
                                         (std::log(fit.s2[i]) + conditional[i].mean_square / fit.s2[i]) +
                                     conditional[i].penalty + parts[i].log_determinant());
      break;
    }
    update_variances(problem, conditional, fit);
    if (grows) fit.per_gain = per_gain_of(problem, columns, slopes, fit.coefficient);
  }

  const VectorXd v = with_minus(fit.coefficient);
  fit.adapted.resize(n_records);
  fit.plain.resize(n_records);
  fit.zeta.resize(n_records);
  fit.gain.resize(n_records);
  for (std::size_t i = 0; i < n_records; ++i) {
    fit.adapted[i] = conditional[i].mean_square;
    fit.gain[i] = parts[i].gain(fit.coefficient, conditional[i].zeta[0]);
    fit.zeta[i] = conditional[i].zeta;
    fit.plain[i] = parts[i].plain(v);
  }
  fit.valid = true;
  return fit;
}

void flip_residuals(MixedProblem& problem, const MixedFit& fit, const std::vector<int>& sign) {
  VectorXd beta = VectorXd::Zero(problem.nz + problem.ns);
  beta.head(problem.n_fixed) = fit.coefficient.head(problem.n_fixed);
  for (const int column : fit.columns) beta[problem.nz + column] = fit.strength_of(column);
  problem.other_y.resize(problem.records.size());
  for (std::size_t i = 0; i < problem.records.size(); ++i) {
    const MatrixXd& G = problem.records[i].gram;
    const Index y = problem.y_index();
    VectorXd out = G.col(y);
    if (sign[i] < 0) {
      const VectorXd of_fit = G.leftCols(y) * beta;  // X' X beta, last: y' X beta
      out = 2.0 * of_fit - out;
      out[y] = 4.0 * beta.dot(of_fit.head(y)) - 4.0 * of_fit[y] + G(y, y);
    }
    problem.other_y[i] = std::move(out);
  }
}

double strength_scatter(const MixedProblem& problem, const MixedFit& fit, const std::vector<int>& columns) {
  const VectorXd sigma2 = expand_variance(problem, fit.variance);
  const Index d = fit.coefficient.size();
  VectorXd effect = VectorXd::Zero(d + 1), rest = with_minus(fit.coefficient);
  for (const int column : columns)
    if (const auto at = fit.place_of(column)) {
      effect[*at] = fit.coefficient[*at];
      rest[*at] = 0.0;
    }
  // one noise for all: a record that the effect does not fit would else be the one that counts least
  double pooled = 0.0;
  for (double s2 : fit.s2) pooled += s2 / static_cast<double>(fit.s2.size());
  double information = 0.0, scatter = 0.0, n = 0.0;
  for (std::size_t i = 0; i < problem.records.size(); ++i) {
    RecordPart part(problem, i, fit.columns);
    part.set_own_gain(fit.per_gain);
    part.eliminate(sigma2, problem.records[i].n_eff / pooled);
    const MatrixXd marginal = part.marginal();
    const auto M = marginal.topRows(d + 1).selfadjointView<Eigen::Lower>();
    const double w = effect.dot(M * effect);
    if (!(w > 1e-9)) continue;
    const double lambda = effect.dot(M * rest) / w;
    information += w;
    scatter += w * (lambda - 1.0) * (lambda - 1.0);
    n += 1.0;
  }
  return information > 0.0 ? std::sqrt(std::max(0.0, scatter - n) / information) : 0.0;
}

MixedFit at_freedom_of(const MixedProblem& problem, MixedFit fit, const MixedFit& freedom) {
  Conditional conditional;
  fit.zeta.resize(problem.records.size());
  fit.gain.resize(problem.records.size());
  fit.adapted.resize(problem.records.size());
  for (std::size_t i = 0; i < problem.records.size(); ++i) {
    RecordPart part(problem, i, fit.columns);
    part.set_own_gain(fit.per_gain);
    part.eliminate(own_variance(problem, freedom, problem.records[i]), problem.records[i].n_eff / freedom.s2[i]);
    part.condition(with_minus(fit.coefficient), conditional);
    fit.zeta[i] = conditional.zeta;
    fit.gain[i] = part.gain(fit.coefficient, conditional.zeta[0]);
    fit.adapted[i] = conditional.mean_square;
  }
  return fit;
}

std::vector<double> adapted_errors(const MixedProblem& problem, const MixedFit& fit, const MixedFit& freedom) {
  return at_freedom_of(problem, fit, freedom).adapted;
}

namespace {

std::vector<Index> fixed_columns(const MixedProblem& problem, bool VarianceComponent::*which) {
  std::vector<Index> out;
  for (Index j = 0; j < problem.n_fixed; ++j)
    if (problem.components[static_cast<std::size_t>(problem.component_of_z[static_cast<std::size_t>(j)])].*which) out.push_back(j);
  return out;
}

// Of the fixed parts of nuisance columns, as the records other than each one leave them, at given strengths; 0 for other columns.
std::vector<VectorXd> nuisance_variance(const MixedProblem& problem, std::vector<RecordPart>& parts, const MixedFit& fit,
                                        const MixedFit& freedom) {
  const Index n = problem.n_fixed;
  VectorXd nuisance = VectorXd::Zero(n);
  for (const Index j : fixed_columns(problem, &VarianceComponent::nuisance)) nuisance[j] = 1.0;
  if (nuisance.isZero()) return std::vector<VectorXd>(parts.size(), nuisance);
  const VectorXd sigma2 = expand_variance(problem, freedom.variance);
  MatrixXd total = problem.fixed_prior_sd.cwiseAbs2().cwiseInverse().asDiagonal();
  std::vector<MatrixXd> own;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].eliminate(sigma2, problem.records[i].n_eff / freedom.s2[i]);
    own.push_back(fit.counts(problem.records[i]) ? MatrixXd(parts[i].marginal().topLeftCorner(n, n)) : MatrixXd::Zero(n, n));
    total += own.back();
  }
  std::vector<VectorXd> out;
  for (const MatrixXd& one : own)
    out.push_back(MatrixXd(total - one).llt().solve(MatrixXd::Identity(n, n)).diagonal().cwiseProduct(nuisance));
  return out;
}

}  // namespace

LeftOut leave_one_out(const MixedProblem& problem, const MixedFit& fit, const MixedFit* freedom) {
  const std::size_t n_records = problem.records.size();
  const Index d = fit.coefficient.size();
  const VectorXd sigma2 = expand_variance(problem, fit.variance);
  const VectorXd prior = prior_precision(problem, fit.columns), pull = prior.cwiseProduct(prior_mean(problem, fit.columns));
  std::vector<RecordPart> parts;
  parts.reserve(n_records);
  std::vector<MatrixXd> single;
  MatrixXd total;
  for (std::size_t i = 0; i < n_records; ++i) {
    parts.emplace_back(problem, i, fit.columns);
    parts[i].set_own_gain(fit.per_gain);
    parts[i].eliminate(sigma2, problem.records[i].n_eff / fit.s2[i]);
    single.push_back(parts[i].marginal());
    if (total.size() == 0) total = MatrixXd::Zero(single.back().rows(), single.back().cols());
    if (fit.counts(problem.records[i])) total += single.back();
  }
  LeftOut out{std::vector<double>(n_records), std::vector<double>(n_records)};
  VectorXd plain_prior = prior;
  for (Index j = 0; j < problem.plain_prior_sd.size(); ++j) plain_prior[j] = 1.0 / (problem.plain_prior_sd[j] * problem.plain_prior_sd[j]);
  std::vector<VectorXd> uncertain;
  if (freedom != nullptr) uncertain = nuisance_variance(problem, parts, fit, *freedom);
  const std::vector<Index> known = fixed_columns(problem, &VarianceComponent::told_by_all);
  Conditional conditional;
  for (std::size_t i = 0; i < n_records; ++i) {
    const bool counts = fit.counts(problem.records[i]);
    const MatrixXd others = counts ? MatrixXd(total - single[i]) : total;
    const auto told = [&](const VectorXd& by) {
      MatrixXd P = others.topLeftCorner(d, d).selfadjointView<Eigen::Lower>();
      P.diagonal() += by;
      VectorXd pulled = others.row(d).head(d).transpose() + pull;
      for (const Index j : known) {
        pulled -= P.col(j) * fit.coefficient[j];
        P.row(j).setZero();
        P.col(j).setZero();
        P(j, j) = 1.0;
      }
      for (const Index j : known) pulled[j] = fit.coefficient[j];
      return with_minus(P.llt().solve(pulled));
    };
    const VectorXd v = told(plain_prior);
    const double n_eff = problem.records[i].n_eff;
    if (freedom != nullptr) {
      VectorXd own = expand_variance(problem, freedom->variance);
      own.head(problem.n_fixed) += uncertain[i];
      parts[i].eliminate(own, n_eff / freedom->s2[i]);
    }
    parts[i].condition(v, conditional);
    out.adapted[i] = conditional.mean_square;
    out.plain[i] = parts[i].plain(v);
  }
  return out;
}

}  // namespace forcegate::diagnose
