#include "hil/diagnose/refit/law_fitter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "hil/diagnose/refit/seen_terms.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kStep = 0.02;  // of log b and log q, for differences
constexpr double kRidge = 1e-9;

BaseLaw moved(BaseLaw law, const Vector2d& step) {
  law.b_scale *= std::exp(step[0]);
  law.q_scale *= std::exp(step[1]);
  return law;
}

// Points about the present law of which a quadratic is made.
const std::array<Vector2d, 6> kAround = {Vector2d(0.0, 0.0), Vector2d(kStep, 0.0), Vector2d(-kStep, 0.0), Vector2d(0.0, kStep), Vector2d(0.0, -kStep), Vector2d(kStep, kStep)};

// Newton's step to the minimum, of values at kAround; where it bends down, away from it all the same, at most 0.3.
Vector2d newton_step(const std::array<double, 6>& value) {
  constexpr double kLongest = 0.3;
  const auto [here, b1, b0, q1, q0, both] = value;
  const Vector2d gradient((b1 - b0) / (2.0 * kStep), (q1 - q0) / (2.0 * kStep));
  Matrix2d H;
  H(0, 0) = (b1 - 2.0 * here + b0) / (kStep * kStep);
  H(1, 1) = (q1 - 2.0 * here + q0) / (kStep * kStep);
  H(0, 1) = H(1, 0) = (both - b1 - q1 + here) / (kStep * kStep);
  const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(H);
  const Vector2d d = eigen.eigenvalues().cwiseAbs().cwiseMax(1e-3 * eigen.eigenvalues().cwiseAbs().maxCoeff() + 1e-15);
  const Vector2d step = -(eigen.eigenvectors() * d.cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose()) * gradient;
  const double longest = step.cwiseAbs().maxCoeff();
  return longest > kLongest ? Vector2d(step * (kLongest / longest)) : step;
}

}  // namespace

// Weighted rows: sqrt(1/n) each, so that records weigh the same.
Result<LawGram> LawFitter::gram(RecordInput& r, const BaseLaw& law, const std::vector<FormAtShape>& effects) const {
  set_decay(r, law);
  Index columns = 2;
  for (const FormAtShape& c : effects) columns += static_cast<Index>(c.form->strength.size());
  const auto n = static_cast<Index>(r.rows());
  MatrixXd X = MatrixXd::Zero(n, columns);
  for (Index i = 0; i < n; ++i) X(i, 0) = r.base_force_N(static_cast<std::size_t>(i));
  X.col(1).setOnes();
  Index at = 2;
  for (const FormAtShape& c : effects) {
    const auto count = static_cast<Index>(c.form->strength.size());
    c.form->columns(input_, r, c.shape, X.middleCols(at, count));
    for (Index j = 0; j < count; ++j)
      if (!is_seen(*c.form, static_cast<std::size_t>(j), input_)) X.col(at + j).setZero();
    at += count;
  }
  VectorXd y(n);
  for (Index i = 0; i < n; ++i) y[i] = r.U_V[static_cast<std::size_t>(i)];
  double used = 0.0, above_0 = 0.0;
  for (Index i = 0; i < n; ++i)
    if (r.ok[static_cast<std::size_t>(i)] == 0 || !std::isfinite(y[i])) {
      X.row(i).setZero();
      y[i] = 0.0;
    } else {
      used += 1.0;
      above_0 += y[i] > 0.0 ? 1.0 : 0.0;
    }
  if (above_0 < 0.5 * used)
    return fail(ErrorCode::parse, "most of the output is not above 0", r.name,
                "a compensator divides by an output that grows from 0: turn the sign of an inverting amplifier");
  used = std::max(1.0, used);
  return LawGram{X.transpose() * X / used, X.transpose() * y / used, y.squaredNorm() / used};
}

Result<std::vector<LawGram>> LawFitter::grams(const BaseLaw& law, const std::vector<FormAtShape>& effects) {
  std::vector<LawGram> out;
  for (RecordInput& r : input_.records) {
    FORCEGATE_TRY(LawGram g, gram(r, law, effects));
    out.push_back(std::move(g));
  }
  return out;
}

VectorXd LawFitter::solve(const std::vector<LawGram>& grams, std::size_t left_out) {
  const Index m = grams.front().Xy.size();
  MatrixXd A = MatrixXd::Zero(m, m);
  VectorXd b = VectorXd::Zero(m);
  for (std::size_t k = 0; k < grams.size(); ++k)
    if (k != left_out) A += grams[k].XX, b += grams[k].Xy;
  const double least = 1e-12 * A.diagonal().maxCoeff();
  for (Index j = 0; j < m; ++j)
    if (A(j, j) <= least) {
      A.row(j).setZero();
      A.col(j).setZero();
      A(j, j) = 1.0;
      b[j] = 0.0;
    }
  A.diagonal() *= 1.0 + kRidge;
  return A.ldlt().solve(b);
}

double LawFitter::square_error(const LawGram& g, const VectorXd& beta) {
  return std::max(0.0, g.yy - 2.0 * beta.dot(g.Xy) + beta.dot(g.XX * beta));
}

double LawFitter::error(const std::vector<LawGram>& g) {
  const VectorXd beta = solve(g, g.size());
  double sum = 0.0;
  for (const LawGram& one : g) sum += square_error(one, beta);
  return std::sqrt(sum / static_cast<double>(g.size()));
}

double LawFitter::left_out(const std::vector<LawGram>& g) {
  double sum = 0.0;
  for (std::size_t k = 0; k < g.size(); ++k) sum += square_error(g[k], solve(g, k));
  return std::sqrt(sum / static_cast<double>(g.size()));
}

Result<BaseLaw> LawFitter::refine(BaseLaw law, const std::vector<FormAtShape>& effects, int rounds) {
  if (!law.decays) return law;
  const auto square_at = [&](const Vector2d& step) -> Result<double> {
    FORCEGATE_TRY(const std::vector<LawGram> g, grams(moved(law, step), effects));
    const double e = error(g);
    return e * e;
  };
  std::array<double, kAround.size()> value{};
  FORCEGATE_TRY(value[0], square_at(kAround[0]));
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 1; k < kAround.size(); ++k) {
      FORCEGATE_TRY(value[k], square_at(kAround[k]));
    }
    Vector2d step = newton_step(value);
    bool better = false;
    for (int half = 0; half < 5 && !better; ++half, step *= 0.5) {
      FORCEGATE_TRY(const double there, square_at(step));
      if (there >= value[0]) continue;
      law = moved(law, step);
      better = value[0] - there > 1e-5 * value[0];
      value[0] = there;
      if (!better) break;
    }
    if (!better) break;
  }
  return law;
}

Result<Vector2d> LawFitter::jackknife_of_decay(const BaseLaw& law, const std::vector<FormAtShape>& effects) {
  const std::size_t records = input_.records.size();
  if (!law.decays || records < 2) return Vector2d(0.0, 0.0);
  std::array<std::vector<LawGram>, kAround.size()> at;
  for (std::size_t k = 0; k < kAround.size(); ++k) {
    FORCEGATE_TRY(at[k], grams(moved(law, kAround[k]), effects));
  }
  const auto n = static_cast<double>(records);
  Vector2d mean = Vector2d::Zero(), square = mean;
  for (std::size_t left = 0; left < records; ++left) {
    std::array<double, kAround.size()> value{};
    for (std::size_t k = 0; k < kAround.size(); ++k) {
      const VectorXd beta = solve(at[k], left);
      for (std::size_t other = 0; other < records; ++other)
        if (other != left) value[k] += square_error(at[k][other], beta) / (n - 1.0);
    }
    const Vector2d step = newton_step(value);
    mean += step / n;
    square += step.cwiseAbs2() / n;
  }
  return Vector2d(((square - mean.cwiseAbs2()).cwiseMax(0.0) * (n - 1.0)).cwiseSqrt());
}

}  // namespace forcegate::diagnose
