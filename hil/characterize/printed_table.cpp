#include "hil/characterize/printed_table.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "hil/characterize/laws.h"
#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

constexpr std::array<PrintedRow, 20> kTableII{{
    {0.05, 1.5, 2.7, 2.16, 4.32e-3, 0.83, 0.072},  {0.15, 1.5, 2.7, 3.24, 7.46e-3, 0.67, 0.102},
    {0.25, 1.5, 2.7, 3.37, 5.57e-3, 0.69, 0.056},  {0.50, 1.5, 2.7, 3.48, 7.01e-3, 0.89, 0.064},
    {1.00, 1.5, 2.7, 3.60, 7.07e-3, 0.82, 0.083},  {1.50, 1.5, 2.7, 2.87, 8.10e-3, 0.63, 0.061},
    {2.00, 1.5, 2.7, 2.00, 5.57e-3, 0.82, 0.079},  {2.50, 1.5, 2.7, 3.13, 12.2e-3, 0.53, 0.039},
    {3.00, 1.5, 2.7, 4.06, 18.9e-3, 0.45, 0.091},  {4.00, 1.5, 2.7, 2.38, 8.57e-3, 0.59, 0.062},
    {0.50, 0.44, 2.4, 0.44, 9.04e-3, 0.29, 0.006}, {0.50, 0.98, 2.4, 1.98, 8.47e-3, 0.67, 0.043},
    {0.50, 1.23, 2.4, 2.19, 7.56e-3, 0.73, 0.053}, {0.50, 1.47, 2.4, 3.39, 5.13e-3, 0.48, 0.076},
    {0.50, 1.76, 2.4, 4.19, 4.85e-3, 0.47, 0.053}, {0.50, 0.8, 1.77, 1.86, 6.76e-3, 0.56, 0.063},
    {0.50, 0.8, 1.96, 1.73, 6.18e-3, 0.53, 0.064}, {0.50, 0.8, 2.45, 1.29, 6.79e-3, 0.57, 0.023},
    {0.50, 0.8, 2.94, 1.07, 8.35e-3, 0.38, 0.027}, {0.50, 0.8, 3.43, 1.14, 7.27e-3, 0.52, 0.026},
}};

constexpr std::array<PrintedPair, 9> kTableIII{{{0.33, 0.5, 37, 8, 4},
                                                {0.08, 0.2, 41, 11, 9},
                                                {0.5, 1.5, 41, 36, 14},
                                                {0.5, 2, 19, 9, 3},
                                                {0.1, 0.5, 26, 45, 11},
                                                {0.05, 0.5, 17, 30, 13},
                                                {0.02, 0.5, 25, 92, 7},
                                                {0.01, 0.5, 33, 15, 4},
                                                {0.01, 1, 13, 37, 8}}};

constexpr double kSignificance = 0.05, kDuration_s = 1200.0;

double loss_of(double a, double b, double c) { return 1.0 - (a * std::exp(-b * kDuration_s) + c) / (a + c); }

struct LeastSquares {
  Eigen::VectorXd beta;
  Eigen::MatrixXd inverse;
  double sum_of_squares = 0, loo_pct = 0;
  Eigen::Index dof = 0;
};

// Relative least squares of y = X beta: rows are divided by y, so that every residual is a relative error.
LeastSquares relative_fit(const Eigen::MatrixXd& X, const Eigen::VectorXd& y) {
  const Eigen::MatrixXd W = y.cwiseInverse().asDiagonal() * X;
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(y.size());
  LeastSquares out;
  out.inverse = (W.transpose() * W).inverse();
  out.beta = out.inverse * W.transpose() * one;
  const Eigen::VectorXd residual = one - W * out.beta;
  out.sum_of_squares = residual.squaredNorm();
  out.dof = X.rows() - X.cols();
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double leverage = W.row(i) * out.inverse * W.row(i).transpose();
    out.loo_pct += 100.0 * std::abs(residual[i] / (1.0 - leverage)) / static_cast<double>(y.size());
  }
  return out;
}

using Term = std::function<double(const PrintedRow&)>;
struct NamedTerm {
  std::string name;
  Term value;
};
struct Law {
  std::string parameter;
  std::vector<Term> terms;  ///< of eq. (5), linear in its coefficients
  Term offset;              ///< fixed part
  Term value;
  std::vector<NamedTerm> candidates;  ///< multiplied by the value's scale to be relative
};

std::vector<Law> laws_of_paper() {
  const Term f = [](const PrintedRow&r) { return r.f_Hz; }, A = [](const PrintedRow&r) { return r.A_N; },
             m = [](const PrintedRow&r) { return r.m_N; },
             A2 = [](const PrintedRow&r) { return r.A_N * r.A_N; },
             one = [](const PrintedRow&) { return 1.0; }, none = [](const PrintedRow&) { return 0.0; },
             ln_f = [](const PrintedRow&r) { return std::log(r.f_Hz); },
             f2 = [](const PrintedRow&r) { return r.f_Hz * r.f_Hz; },
             low = [](const PrintedRow&r) { return r.m_N - r.A_N; };
  // a is of the order of A and (a/c - 1) of A^2: their candidates are multiplied by these.
  const auto times = [](const Term& x, const Term& y) {
    return [x, y](const PrintedRow& r) { return x(r) * y(r); };
  };
  return {
      {"a",
       {A2, A},
       none,
       [](const PrintedRow& r) { return r.a_V; },
       {{"m", times(m, A)}, {"f", times(f, A)}, {"ln f", times(ln_f, A)}, {"m - A", times(low, A)}}},
      {"b",
       {f, one},
       none,
       [](const PrintedRow& r) { return 1e3 * r.b_per_s; },
       {{"A", A}, {"m", m}, {"ln f", ln_f}, {"f^2", f2}, {"m - A", low}}},
      {"c/a",
       {A2},
       one,
       [](const PrintedRow& r) { return r.a_V / r.c_V; },
       {{"A", A},
        {"m", times(m, A2)},
        {"f", times(f, A2)},
        {"ln f", times(ln_f, A2)},
        {"m - A", times(low, A2)}}}};
}

struct Columns {
  Eigen::VectorXd y;  ///< without the fixed part
  Eigen::MatrixXd X;
};

Columns columns_of(const Law& law) {
  const auto n = static_cast<Eigen::Index>(kTableII.size());
  Columns out{Eigen::VectorXd(n), Eigen::MatrixXd(n, static_cast<Eigen::Index>(law.terms.size()))};
  for (Eigen::Index i = 0; i < n; ++i) {
    const PrintedRow& row = kTableII[static_cast<std::size_t>(i)];
    out.y[i] = law.value(row) - law.offset(row);
    for (std::size_t k = 0; k < law.terms.size(); ++k) out.X(i, static_cast<Eigen::Index>(k)) = law.terms[k](row);
  }
  return out;
}

// What a law gains by one more term.
LeftOut with_term(const Law& law, const Columns& of, const LeastSquares& before, const NamedTerm& candidate) {
  const Eigen::Index at = of.X.cols();
  Eigen::MatrixXd X(of.X.rows(), at + 1);
  X.leftCols(at) = of.X;
  for (Eigen::Index i = 0; i < X.rows(); ++i) X(i, at) = candidate.value(kTableII[static_cast<std::size_t>(i)]);
  const LeastSquares after = relative_fit(X, of.y);
  LeftOut out;
  out.parameter = law.parameter;
  out.term = candidate.name;
  out.coefficient = after.beta[at];
  out.se = std::sqrt(after.sum_of_squares / static_cast<double>(after.dof) * after.inverse(at, at));
  out.p = 2.0 * (1.0 - student_cdf(std::abs(out.coefficient / out.se), static_cast<double>(after.dof)));
  out.loo_before_pct = before.loo_pct;
  out.loo_after_pct = after.loo_pct;
  return out;
}

void mark_significant(std::vector<LeftOut>& items) {
  std::vector<double> p;
  for (const LeftOut& item : items) p.push_back(item.p);
  const std::vector<bool> rejected = holm(p, kSignificance);
  for (std::size_t i = 0; i < items.size(); ++i) items[i].significant = rejected[i];
}

}  // namespace

std::span<const PrintedRow> printed_table_II() { return kTableII; }
std::span<const PrintedPair> printed_table_III() { return kTableIII; }

PrintedErrors errors_on_printed_table() {
  const Laws laws;
  PrintedErrors e;
  for (const PrintedRow& r : kTableII) {
    const double n = static_cast<double>(kTableII.size());
    const double a = laws.a_V(r.A_N), b = laws.b_per_s(r.f_Hz), c = a * laws.ratio(r.A_N);
    e.a_pct += 100.0 * std::abs(a / r.a_V - 1.0) / n;
    e.b_pct += 100.0 * std::abs(b / r.b_per_s - 1.0) / n;
    e.c_pct += 100.0 * std::abs(c / r.c_V - 1.0) / n;
    e.loss_printed_pct += 100.0 * loss_of(r.a_V, r.b_per_s, r.c_V) / n;
    e.loss_laws_pct += 100.0 * loss_of(a, b, c) / n;
  }
  return e;
}

std::vector<LeftOut> search_printed_table() {
  std::vector<LeftOut> out;
  for (const Law& law : laws_of_paper()) {
    const Columns columns = columns_of(law);
    const LeastSquares before = relative_fit(columns.X, columns.y);
    for (const NamedTerm& candidate : law.candidates) out.push_back(with_term(law, columns, before, candidate));
  }
  mark_significant(out);
  std::stable_sort(out.begin(), out.end(), [](const LeftOut& x, const LeftOut& y) { return x.p < y.p; });
  return out;
}

}  // namespace forcegate::characterize
