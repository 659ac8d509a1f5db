#include "hil/diagnose/mixed_model.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The part of a record's Gram matrix that one fit needs: Z beside C = [fixed part of Z, chosen S, y].
struct Part {
  MatrixXd zz, zc, cc;
};

Part take(const MixedProblem& problem, std::size_t i, const std::vector<int>& columns) {
  const RecordGram& record = problem.records[i];
  std::vector<Index> c;
  for (int j = 0; j < problem.n_fixed; ++j) c.push_back(j);
  for (int j : columns) c.push_back(problem.nz + j);
  c.push_back(problem.y_index());
  const auto n = static_cast<Index>(c.size());
  Part out{record.gram.topLeftCorner(problem.nz, problem.nz), MatrixXd(problem.nz, n), MatrixXd(n, n)};
  for (Index a = 0; a < n; ++a) {
    out.zc.col(a) = record.gram.col(c[a]).head(problem.nz);
    for (Index b = 0; b < n; ++b) out.cc(b, a) = record.gram(c[b], c[a]);
  }
  if (!problem.other_y.empty()) {
    const VectorXd& y = problem.other_y[i];
    out.zc.col(n - 1) = y.head(problem.nz);
    for (Index b = 0; b < n; ++b) out.cc(b, n - 1) = out.cc(n - 1, b) = y[c[b]];
  }
  return out;
}

VectorXd expand_variance(const MixedProblem& problem, const VectorXd& variance) {
  VectorXd out(problem.nz);
  for (int j = 0; j < problem.nz; ++j) out[j] = variance[problem.component_of_z[j]];
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

struct Conditional {
  VectorXd zeta;
  double mean_square = 0.0, penalty = 0.0, log_det = 0.0;
  VectorXd zeta_variance;
  double trace = 0.0;
};

Conditional condition(const Part& part, const VectorXd& v, const VectorXd& sigma2, double weight) {
  MatrixXd A = weight * part.zz;
  A.diagonal() += sigma2.cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(A);
  const VectorXd ze = part.zc * v;
  Conditional out;
  out.zeta = llt.solve(weight * ze);
  out.mean_square =
      std::max(0.0, v.dot(part.cc * v) - 2.0 * out.zeta.dot(ze) + out.zeta.dot(part.zz * out.zeta));
  out.penalty = out.zeta.cwiseAbs2().cwiseQuotient(sigma2).sum();
  const MatrixXd inverse = llt.solve(MatrixXd::Identity(A.rows(), A.cols()));
  out.zeta_variance = inverse.diagonal();
  out.trace = (part.zz.cwiseProduct(inverse)).sum();
  double half = 0.0;
  for (Index j = 0; j < A.rows(); ++j) half += std::log(llt.matrixL()(j, j));
  out.log_det = 2.0 * half + sigma2.array().log().sum();
  return out;
}

// Marginal Gram of C in units of precision: what is left after the record's own zeta is integrated out.
MatrixXd marginal(const Part& part, const VectorXd& sigma2, double weight) {
  MatrixXd A = weight * part.zz;
  A.diagonal() += sigma2.cwiseInverse();
  const Eigen::LLT<MatrixXd> llt(A);
  return weight * part.cc - weight * weight * (part.zc.transpose() * llt.solve(part.zc));
}

VectorXd with_minus(const VectorXd& coefficient) {
  VectorXd v(coefficient.size() + 1);
  v.head(coefficient.size()) = -coefficient;
  v[coefficient.size()] = 1.0;
  return v;
}

}  // namespace

MixedFit fit_mixed(const MixedProblem& problem, const std::vector<int>& columns, const MixedFit* warm,
                   int iterations, RecordUse use) {
  const std::size_t n_records = problem.records.size();
  const Index d = problem.n_fixed + static_cast<Index>(columns.size());
  MixedFit fit;
  fit.columns = columns;
  fit.use = use;
  std::vector<Part> parts;
  for (std::size_t i = 0; i < n_records; ++i) parts.push_back(take(problem, i, columns));

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

  const VectorXd prior = prior_precision(problem, columns);
  std::vector<Conditional> conditional(n_records);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const VectorXd sigma2 = expand_variance(problem, fit.variance);
    MatrixXd M = MatrixXd::Zero(d + 1, d + 1);
    for (std::size_t i = 0; i < n_records; ++i)
      if (fit.counts(problem.records[i]))
        M += marginal(parts[i], sigma2, problem.records[i].n_eff / fit.s2[i]);
    MatrixXd P = M.topLeftCorner(d, d);
    P.diagonal() += prior;
    const Eigen::LLT<MatrixXd> llt(P);
    if (llt.info() != Eigen::Success) return fit;
    fit.coefficient = llt.solve(M.col(d).head(d));
    fit.covariance = llt.solve(MatrixXd::Identity(d, d));
    const VectorXd v = with_minus(fit.coefficient);

    double log_evidence = 0.0;
    VectorXd sum = VectorXd::Zero(n_components), count = VectorXd::Zero(n_components);
    for (std::size_t i = 0; i < n_records; ++i) {
      const RecordGram& record = problem.records[i];
      conditional[i] = condition(parts[i], v, sigma2, record.n_eff / fit.s2[i]);
      const Conditional& c = conditional[i];
      if (fit.counts(record)) {
        log_evidence -= 0.5 * (record.n_eff * std::log(fit.s2[i]) + record.n_eff * c.mean_square / fit.s2[i] +
                               c.penalty + c.log_det);
        for (int j = 0; j < problem.nz; ++j) {
          if (parts[i].zz(j, j) < 1e-14) continue;  // the record does not excite this column
          const int k = problem.component_of_z[j];
          sum[k] += c.zeta[j] * c.zeta[j] + c.zeta_variance[j];
          count[k] += 1.0;
        }
      }
    }
    double half = 0.0;
    for (Index j = 0; j < d; ++j) half += std::log(llt.matrixL()(j, j));
    log_evidence +=
        -half + 0.5 * prior.array().log().sum() - 0.5 * fit.coefficient.cwiseAbs2().cwiseProduct(prior).sum();
    for (Index k = 0; k < n_components; ++k) {
      const VarianceComponent& c = problem.components[k];
      const double prior2 = c.prior_sd * c.prior_sd;
      log_evidence -= 0.5 * c.prior_weight * (std::log(fit.variance[k]) + prior2 / fit.variance[k]);
    }
    fit.log_evidence = log_evidence;
    if (iteration + 1 == iterations) break;
    for (Index k = 0; k < n_components; ++k) {
      const VarianceComponent& c = problem.components[k];
      fit.variance[k] = (c.prior_weight * c.prior_sd * c.prior_sd + sum[k]) / (c.prior_weight + count[k]);
    }
    for (std::size_t i = 0; i < n_records; ++i)
      fit.s2[i] =
          std::max(conditional[i].mean_square + conditional[i].trace, problem.records[i].noise_variance);
  }

  const VectorXd v = with_minus(fit.coefficient);
  fit.adapted.resize(n_records);
  fit.plain.resize(n_records);
  fit.zeta.resize(n_records);
  for (std::size_t i = 0; i < n_records; ++i) {
    fit.adapted[i] = conditional[i].mean_square;
    fit.zeta[i] = conditional[i].zeta;
    fit.plain[i] = std::max(0.0, v.dot(parts[i].cc * v));
  }
  fit.valid = true;
  return fit;
}

void flip_residuals(MixedProblem& problem, const MixedFit& fit, const std::vector<int>& sign) {
  VectorXd beta = VectorXd::Zero(problem.nz + problem.ns);
  beta.head(problem.n_fixed) = fit.coefficient.head(problem.n_fixed);
  for (std::size_t b = 0; b < fit.columns.size(); ++b)
    beta[problem.nz + fit.columns[b]] = fit.coefficient[problem.n_fixed + static_cast<Index>(b)];
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
  for (std::size_t b = 0; b < fit.columns.size(); ++b)
    if (std::find(columns.begin(), columns.end(), fit.columns[b]) != columns.end()) {
      const Index at = problem.n_fixed + static_cast<Index>(b);
      effect[at] = fit.coefficient[at];
      rest[at] = 0.0;
    }
  // one noise for all: a record that the effect does not fit would else be the one that counts least
  double pooled = 0.0;
  for (double s2 : fit.s2) pooled += s2 / static_cast<double>(fit.s2.size());
  double information = 0.0, scatter = 0.0, n = 0.0;
  for (std::size_t i = 0; i < problem.records.size(); ++i) {
    const MatrixXd M = marginal(take(problem, i, fit.columns), sigma2, problem.records[i].n_eff / pooled);
    const double w = effect.dot(M * effect);
    if (!(w > 1e-9)) continue;
    const double lambda = effect.dot(M * rest) / w;
    information += w;
    scatter += w * (lambda - 1.0) * (lambda - 1.0);
    n += 1.0;
  }
  return information > 0.0 ? std::sqrt(std::max(0.0, scatter - n) / information) : 0.0;
}

std::vector<double> adapted_errors(const MixedProblem& problem, const MixedFit& fit,
                                   const MixedFit& freedom) {
  const VectorXd sigma2 = expand_variance(problem, freedom.variance);
  std::vector<double> out;
  for (std::size_t i = 0; i < problem.records.size(); ++i)
    out.push_back(condition(take(problem, i, fit.columns), with_minus(fit.coefficient), sigma2,
                            problem.records[i].n_eff / freedom.s2[i])
                      .mean_square);
  return out;
}

LeftOut leave_one_out(const MixedProblem& problem, const MixedFit& fit, const MixedFit* freedom) {
  const std::size_t n_records = problem.records.size();
  const Index d = fit.coefficient.size();
  const VectorXd sigma2 = expand_variance(problem, fit.variance);
  const VectorXd prior = prior_precision(problem, fit.columns);
  std::vector<Part> parts;
  std::vector<MatrixXd> single;
  MatrixXd total = MatrixXd::Zero(d + 1, d + 1);
  for (std::size_t i = 0; i < n_records; ++i) {
    parts.push_back(take(problem, i, fit.columns));
    single.push_back(marginal(parts[i], sigma2, problem.records[i].n_eff / fit.s2[i]));
    if (fit.counts(problem.records[i])) total += single.back();
  }
  // beta and c integrated out, up to what does not depend on the records
  const auto evidence = [&](const MatrixXd& M) {
    MatrixXd P = M.topLeftCorner(d, d);
    P.diagonal() += prior;
    const Eigen::LLT<MatrixXd> llt(P);
    double half = 0.0;
    for (Index j = 0; j < d; ++j) half += std::log(llt.matrixL()(j, j));
    return 0.5 * M.col(d).head(d).dot(llt.solve(M.col(d).head(d))) - half;
  };
  LeftOut out{std::vector<double>(n_records), std::vector<double>(n_records), std::vector<double>(n_records)};
  for (std::size_t i = 0; i < n_records; ++i) {
    const bool counts = fit.counts(problem.records[i]);
    const MatrixXd M = counts ? MatrixXd(total - single[i]) : total;
    MatrixXd P = M.topLeftCorner(d, d);
    P.diagonal() += prior;
    const VectorXd coefficient = P.llt().solve(M.col(d).head(d));
    const VectorXd v = with_minus(coefficient);
    const double n_eff = problem.records[i].n_eff;
    const Conditional c = condition(parts[i], v, sigma2, n_eff / fit.s2[i]);
    out.adapted[i] = freedom == nullptr ? c.mean_square
                                        : condition(parts[i], v, expand_variance(problem, freedom->variance),
                                                    n_eff / freedom->s2[i])
                                              .mean_square;
    out.log_density[i] = evidence(M + single[i]) - evidence(M) -
                         0.5 * (n_eff * std::log(fit.s2[i]) + single[i](d, d) + c.log_det);
    out.plain[i] = std::max(0.0, v.dot(parts[i].cc * v));
  }
  return out;
}

}  // namespace forcegate::diagnose
