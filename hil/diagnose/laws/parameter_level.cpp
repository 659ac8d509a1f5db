#include "hil/diagnose/laws/parameter_level.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/plain_number.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFewest = 6;
constexpr Index kSpare = 3;          // degrees of freedom that a law must leave
constexpr double kSame = 0.95;       // |cos| of two signatures that are alike
constexpr double kCollinear = 1e-6;  // share of a candidate that the law does not hold already

const Covariate* find(const std::vector<Covariate>& all, const std::string& name) {
  const auto at = std::find_if(all.begin(), all.end(), [&](const Covariate& c) { return c.name == name; });
  return at == all.end() ? nullptr : &*at;
}

// A candidate's column, empty when the form is not defined on these values or does not vary.
VectorXd column_of(const LawTerm& term, const std::vector<Covariate>& covariates) {
  const Covariate* x = find(covariates, term.covariate);
  const Covariate* z = term.form == TermForm::product ? find(covariates, term.other) : nullptr;
  if (x == nullptr || (term.form == TermForm::product && z == nullptr)) return {};
  const auto n = static_cast<Index>(x->value.size());
  VectorXd out(n);
  const auto [low, high] = std::minmax_element(x->value.begin(), x->value.end());
  if (!(*high > *low)) return {};
  const bool ratio = term.form == TermForm::logarithm || term.form == TermForm::reciprocal;
  // on a narrow range ln x and 1/x are x again, and at zero they are nothing
  if (ratio && !(*low > 0.0 && *high > 1.3 * *low)) return {};
  for (Index i = 0; i < n; ++i) {
    const double v = x->value[static_cast<std::size_t>(i)];
    switch (term.form) {
      case TermForm::linear: out[i] = v; break;
      case TermForm::logarithm: out[i] = std::log(v); break;
      case TermForm::reciprocal: out[i] = 1.0 / v; break;
      case TermForm::square: out[i] = v * v; break;
      case TermForm::product: out[i] = v * z->value[static_cast<std::size_t>(i)]; break;
    }
  }
  return out;
}

bool differs(const Covariate& c) { return std::ranges::any_of(c.value, [&](double v) { return v != c.value.front(); }); }

// A product with what is the same in every record is the other factor.
std::vector<LawTerm> all_terms(const std::vector<Covariate>& covariates) {
  std::vector<LawTerm> out;
  for (const Covariate& c : covariates)
    for (const TermForm form : {TermForm::linear, TermForm::logarithm, TermForm::reciprocal, TermForm::square}) out.push_back({form, c.name, {}});
  for (std::size_t a = 0; a < covariates.size(); ++a)
    for (std::size_t b = a + 1; b < covariates.size(); ++b)
      if (differs(covariates[a]) && differs(covariates[b])) out.push_back({TermForm::product, covariates[a].name, covariates[b].name});
  return out;
}

bool same(const LawTerm& a, const LawTerm& b) {
  return a.form == b.form && a.covariate == b.covariate && a.other == b.other;
}

// Whitened least squares: rows multiplied by sqrt(weight).
struct Fit {
  MatrixXd Q;         // orthonormal columns of the law
  VectorXd residual;  // whitened
  VectorXd beta, u;
  double rss = 0.0, loo = 0.0;
};

Fit fit_law(const MatrixXd& X, const VectorXd& y, const VectorXd& root_w) {
  const MatrixXd A = root_w.asDiagonal() * X;
  const VectorXd z = root_w.cwiseProduct(y);
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  Fit f;
  f.beta = qr.solve(z);
  f.residual = z - A * f.beta;
  f.rss = f.residual.squaredNorm();
  f.Q = MatrixXd(qr.householderQ() * MatrixXd::Identity(A.rows(), A.cols()));
  const double s2 = f.rss / static_cast<double>(std::max<Index>(1, A.rows() - A.cols()));
  const MatrixXd cov = s2 * (A.transpose() * A).ldlt().solve(MatrixXd::Identity(A.cols(), A.cols()));
  f.u = cov.diagonal().cwiseMax(0.0).cwiseSqrt();
  double sum = 0.0;
  for (Index i = 0; i < A.rows(); ++i) {
    const double leverage = f.Q.row(i).squaredNorm();
    const double e = f.residual[i] / root_w[i] / std::max(1e-6, 1.0 - leverage);
    sum += e * e;
  }
  f.loo = std::sqrt(sum / static_cast<double>(A.rows()));
  return f;
}

// Scatter between records beyond their uncertainties, by moments, with the law's own degrees of freedom.
double scatter_between(const MatrixXd& X, const VectorXd& y, const std::vector<double>& u) {
  double s2 = 0.0;
  const auto n = X.rows();
  for (int round = 0; round < 30; ++round) {
    VectorXd root_w(n);
    for (Index i = 0; i < n; ++i) {
      const double ui = u[static_cast<std::size_t>(i)];
      root_w[i] = 1.0 / std::sqrt(std::max(1e-300, ui * ui + s2));
    }
    const double chi2 = fit_law(X, y, root_w).rss, dof = static_cast<double>(n - X.cols());
    const double mean_w = root_w.squaredNorm() / static_cast<double>(n);
    const double next = std::max(0.0, s2 + (chi2 / dof - 1.0) / mean_w);
    if (std::fabs(next - s2) <= 1e-9 * (next + s2)) return next;
    s2 = next;
  }
  return s2;
}

struct Candidates {
  std::vector<LawTerm> terms;
  MatrixXd Z;  // unit columns orthogonal to the law, whitened
};

Candidates candidates_beside(const ParameterQuestion& q, const std::vector<LawTerm>& law, const Fit& fit,
                             const VectorXd& root_w) {
  Candidates out;
  std::vector<VectorXd> columns;
  for (const LawTerm& term : all_terms(q.covariates)) {
    if (std::any_of(law.begin(), law.end(), [&](const LawTerm& t) { return same(t, term); })) continue;
    VectorXd z = column_of(term, q.covariates);
    if (z.size() == 0) continue;
    z = root_w.cwiseProduct(z);
    const double full = z.squaredNorm();
    z -= fit.Q * (fit.Q.transpose() * z);
    z -= fit.Q * (fit.Q.transpose() * z);
    if (z.squaredNorm() <= kCollinear * full) continue;
    columns.push_back(z / z.norm());
    out.terms.push_back(term);
  }
  out.Z.resize(root_w.size(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) out.Z.col(static_cast<Index>(k)) = columns[k];
  return out;
}

struct Step {
  std::vector<RankedTerm> ranking;  // best first
  std::vector<std::size_t> order;   // candidate of each rank
  double critical_share = 1.0;
};

Step search(const ParameterQuestion& q, const Candidates& c, const Fit& fit, Index law_size,
            const std::string& stream) {
  Step out;
  const Index n = fit.residual.size(), m = c.Z.cols(), dof = n - law_size - 1;
  if (m == 0 || dof < kSpare) return out;
  const VectorXd share = (c.Z.transpose() * fit.residual).array().square() / std::max(1e-300, fit.rss);
  std::vector<int> alone(static_cast<std::size_t>(m), 0), family(static_cast<std::size_t>(m), 0);
  std::vector<double> largest;
  Rng rng(q.seed, fmt::format("parameter_level/{}/{}", q.name, stream));
  VectorXd permuted = fit.residual;
  for (int p = 0; p < q.permutations; ++p) {
    for (Index i = n - 1; i > 0; --i)
      std::swap(permuted[i], permuted[static_cast<Index>(rng.below(static_cast<std::uint64_t>(i) + 1))]);
    const VectorXd e = permuted - fit.Q * (fit.Q.transpose() * permuted);
    const VectorXd s = (c.Z.transpose() * e).array().square() / std::max(1e-300, e.squaredNorm());
    const double top = s.maxCoeff();
    largest.push_back(top);
    for (Index k = 0; k < m; ++k) {
      alone[static_cast<std::size_t>(k)] += s[k] >= share[k];
      family[static_cast<std::size_t>(k)] += top >= share[k];
    }
  }
  out.order.resize(static_cast<std::size_t>(m));
  std::iota(out.order.begin(), out.order.end(), std::size_t{0});
  std::stable_sort(out.order.begin(), out.order.end(), [&](std::size_t a, std::size_t b) {
    return share[static_cast<Index>(a)] > share[static_cast<Index>(b)];
  });
  const double count = q.permutations + 1.0;
  for (const std::size_t k : out.order) {
    RankedTerm r;
    r.term = c.terms[k];
    r.r2 = std::min(1.0, share[static_cast<Index>(k)]);
    r.F = static_cast<double>(dof) * r.r2 / std::max(1e-12, 1.0 - r.r2);
    r.p_alone = (1.0 + alone[k]) / count;
    r.p = (1.0 + family[k]) / count;
    out.ranking.push_back(r);
  }
  std::sort(largest.begin(), largest.end());
  out.critical_share =
      largest[static_cast<std::size_t>((1.0 - q.alpha) * static_cast<double>(largest.size() - 1))];
  return out;
}

Result<VectorXd> response(const ParameterQuestion& q, std::vector<double>& u) {
  VectorXd y(static_cast<Index>(q.value.size()));
  for (Index i = 0; i < y.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double v = q.value[k];
    if (q.scale != ResponseScale::linear && !(v > 0.0))
      return fail(ErrorCode::usage,
                  fmt::format("{} is {:g} in record {}: this scale needs values above 0", q.name, v, k + 1),
                  q.name, "use the linear scale");
    y[i] = q.scale == ResponseScale::linear ? v : q.scale == ResponseScale::logarithm ? std::log(v) : 1.0 / v;
    if (!u.empty())
      u[k] *= q.scale == ResponseScale::linear      ? 1.0
              : q.scale == ResponseScale::logarithm ? 1.0 / v
                                                    : 1.0 / (v * v);
  }
  return y;
}

Result<void> check(const ParameterQuestion& q) {
  const std::size_t n = q.value.size();
  if (n < kFewest)
    return fail(ErrorCode::usage, fmt::format("{} cannot show what {} depends on", counted(n, "record"), q.name), q.name,
                fmt::format("at least {} are needed", kFewest));
  if (!q.u.empty() && q.u.size() != n)
    return fail(ErrorCode::usage, "not every record has an uncertainty", q.name);
  for (const Covariate& c : q.covariates) {
    if (c.value.size() != n)
      return fail(ErrorCode::usage, fmt::format("{} has {} values for {} records", c.name, c.value.size(), n),
                  c.name);
    for (double v : c.value)
      if (!std::isfinite(v))
        return fail(ErrorCode::usage, "a covariate has a missing value", c.name,
                    "leave the record or the covariate out");
  }
  for (std::size_t k = 0; k < q.u.size(); ++k)
    if (!(q.u[k] > 0.0) || !std::isfinite(q.u[k]))
      return fail(ErrorCode::usage, fmt::format("the uncertainty of {} in record {} is {}", q.name, k + 1, q.u[k]), q.name,
                  "each must be a number above 0; leave the record or all uncertainties out");
  if (q.permutations < 1 || !(q.alpha > 0.0 && q.alpha < 1.0))
    return fail(ErrorCode::usage, "at least one permutation and an alpha between 0 and 1 are needed", q.name);
  for (double v : q.value)
    if (!std::isfinite(v)) return fail(ErrorCode::usage, "the parameter has a missing value", q.name);
  return {};
}

// The law as it grows: its terms, and their columns after that of the constant.
struct GrowingLaw {
  explicit GrowingLaw(Index n) : X(MatrixXd::Ones(n, 1)) {}
  void add(const LawTerm& term, const VectorXd& column) {
    terms.push_back(term);
    X.conservativeResize(X.rows(), X.cols() + 1);
    X.col(X.cols() - 1) = column;
  }
  std::vector<LawTerm> terms;
  MatrixXd X;
};

Result<GrowingLaw> given_law(const ParameterQuestion& q, Index n) {
  GrowingLaw law(n);
  for (const LawTerm& term : q.law) {
    const VectorXd column = column_of(term, q.covariates);
    if (column.size() == 0)
      return fail(ErrorCode::usage, "the table does not determine the term " + to_string(term), q.name,
                  "is there such a covariate, and does it vary?");
    const VectorXd beside = column - law.X * law.X.colPivHouseholderQr().solve(column);
    if (beside.squaredNorm() <= kCollinear * (column.array() - column.mean()).matrix().squaredNorm())
      return fail(ErrorCode::usage, to_string(term) + " says nothing that the terms before it do not say already", q.name,
                  "leave it out of the law");
    law.add(term, column);
  }
  if (n - law.X.cols() < kSpare)
    return fail(ErrorCode::usage,
                fmt::format("{} records do not determine a law of {} coefficients", n, law.X.cols()), q.name);
  return law;
}

// Weights of the records under a law, from their uncertainties and the scatter between them; returns that scatter. All alike without
// uncertainties.
double weigh(const MatrixXd& X, const VectorXd& y, const std::vector<double>& u, VectorXd& root_w) {
  if (u.empty()) return 0.0;
  const double s2 = scatter_between(X, y, u);
  for (Index i = 0; i < root_w.size(); ++i)
    root_w[i] = 1.0 / std::sqrt(std::max(1e-300, std::pow(u[static_cast<std::size_t>(i)], 2) + s2));
  return std::sqrt(s2);
}

double loo_with(const MatrixXd& X, const VectorXd& column, const VectorXd& y, const VectorXd& root_w) {
  MatrixXd wider = X;
  wider.conservativeResize(X.rows(), X.cols() + 1);
  wider.col(X.cols()) = column;
  return fit_law(wider, y, root_w).loo;
}

// What is asked, in the response and the weights of the records, and how far the law has grown.
struct Asked {
  const ParameterQuestion& q;
  const GrowingLaw& law;
  const VectorXd &y, &root_w;
  std::uint64_t step;
};

// Whether the best term says nothing more where the rival is in the law: by the test that the best one had to pass.
bool does_as_well(const Asked& asked, const LawTerm& best, const LawTerm& rival) {
  GrowingLaw law = asked.law;
  law.add(rival, column_of(rival, asked.q.covariates));
  const Fit fit = fit_law(law.X, asked.y, asked.root_w);
  Candidates beside = candidates_beside(asked.q, law.terms, fit, asked.root_w);
  const auto at = std::ranges::find_if(beside.terms, [&](const LawTerm& t) { return same(t, best); });
  if (at == beside.terms.end()) return true;
  const MatrixXd column = beside.Z.col(at - beside.terms.begin());
  const Step step = search(asked.q, {{best}, column}, fit, law.X.cols(), fmt::format("{}/beside {}", asked.step, to_string(rival)));
  return step.ranking.empty() || step.ranking.front().p_alone > asked.q.alpha;
}

// Terms that these records cannot tell from the best one, neither by their columns nor by what they leave.
std::vector<LawTerm> as_good_as_best(const Asked& asked, const Candidates& c, const Step& found) {
  std::vector<LawTerm> out;
  const auto column = [&](std::size_t rank) { return c.Z.col(static_cast<Index>(found.order[rank])); };
  for (std::size_t k = 1; k < found.order.size(); ++k)
    if (std::fabs(column(0).dot(column(k))) > kSame && does_as_well(asked, found.ranking.front().term, found.ranking[k].term)) out.push_back(found.ranking[k].term);
  return out;
}

std::string sentence_of(const ParameterAnswer& a) {
  if (a.candidates == 0)
    return fmt::format("{} records leave no room to look for another term in the law of {}", a.n, a.name);
  if (a.added.empty())
    return fmt::format(
        "no further dependence of {} is significant with {} records: one that takes less than {:.0f} % of the scatter away would not be seen",
        a.name, a.n, 100.0 * a.smallest_share);
  std::string text = fmt::format("the law of {} lacks ", a.name);
  for (std::size_t k = 0; k < a.added.size(); ++k) {
    const FoundTerm& f = a.added[k];
    text += fmt::format("{}{} (p {:.2g} over {} candidates)", k == 0 ? "" : ", then ",
                        to_string(f.found.term), f.found.p, a.candidates);
    if (!f.fits_as_well.empty())
      text += fmt::format(", or {} of the same size here", to_string(f.fits_as_well.front()));
  }
  return text + fmt::format("; leave-one-out error {:.3g} -> {:.3g}{}", a.loo_before, a.loo_after,
                            a.unit.empty() ? "" : " " + a.unit);
}

}  // namespace

Result<ParameterAnswer> missing_dependence(const ParameterQuestion& q) {
  FORCEGATE_CHECK_OK(check(q));
  std::vector<double> u = q.u;
  FORCEGATE_TRY(const VectorXd y, response(q, u));
  const Index n = y.size();
  FORCEGATE_TRY(GrowingLaw law, given_law(q, n));
  VectorXd root_w = VectorXd::Ones(n);
  ParameterAnswer out;
  out.name = q.name;
  out.unit = q.unit;
  out.response = to_string({q.scale == ResponseScale::logarithm ? TermForm::logarithm : q.scale == ResponseScale::reciprocal ? TermForm::reciprocal : TermForm::linear, q.name, {}});
  out.n = q.value.size();
  out.loo_constant = fit_law(MatrixXd::Ones(n, 1), y, root_w).loo;
  weigh(law.X, y, u, root_w);
  Fit fit = fit_law(law.X, y, root_w);
  out.loo_before = fit.loo;
  for (std::uint64_t step = 0;; ++step) {
    const Candidates c = candidates_beside(q, law.terms, fit, root_w);
    Step found = search(q, c, fit, law.X.cols(), std::to_string(step));
    if (found.ranking.empty()) break;
    for (RankedTerm& r : found.ranking) r.loo_after = loo_with(law.X, column_of(r.term, q.covariates), y, root_w);
    if (step == 0) {
      out.candidates = c.terms.size();
      out.ranking = found.ranking;
      out.smallest_share = found.critical_share;
    }
    const RankedTerm& best = found.ranking.front();
    // significant, and it predicts a record that it was not fitted to
    if (best.p > q.alpha || best.loo_after >= fit.loo) break;
    out.added.push_back({best, fit.loo, as_good_as_best({q, law, y, root_w, step}, c, found)});
    law.add(best.term, column_of(best.term, q.covariates));
    weigh(law.X, y, u, root_w);
    fit = fit_law(law.X, y, root_w);
  }
  out.scatter = u.empty() ? std::sqrt(fit.rss / static_cast<double>(n - law.X.cols())) : weigh(law.X, y, u, root_w);
  out.loo_after = fit.loo;
  out.law.push_back({"1", fit.beta[0], fit.u[0]});
  for (Index k = 1; k < law.X.cols(); ++k)
    out.law.push_back({to_string(law.terms[static_cast<std::size_t>(k - 1)]), fit.beta[k], fit.u[k]});
  out.sentence = sentence_of(out);
  return out;
}

}  // namespace forcegate
