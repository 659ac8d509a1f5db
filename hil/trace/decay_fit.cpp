#include "hil/trace/decay_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>
#include <vector>

#include "hil/base/portable_math.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kLogSlowest = -11.512925464970229;  // ln 1e-5
constexpr double kLogFastest = 0.0;                  // ln 1
constexpr int kGrid = 60;

/// a, level = u_min + c and the residual sum of squares that are best for one b. Time runs from the first point, so
/// that a record that begins late is as well conditioned as one that begins at 0.
struct Projection {
  double a = 0.0, level = 0.0, sum_of_squares = 0.0;
};

class DecayProblem {
 public:
  DecayProblem(std::span<const double> t_s, std::span<const double> y) : t_(t_s.begin(), t_s.end()), y_(y) {
    const double first = *std::min_element(t_.begin(), t_.end());
    for (double& t : t_) t -= first;
    for (const double v : y_) mean_ += v;
    mean_ /= static_cast<double>(y_.size());
  }

  Projection project(double log_b) const {
    const double b = portable::exp(log_b), n = static_cast<double>(y_.size());
    double e_sum = 0.0, ee = 0.0, ey = 0.0, yy = 0.0;
    for (std::size_t i = 0; i < y_.size(); ++i) {
      const double e = portable::exp(-b * t_[i]), d = y_[i] - mean_;
      e_sum += e;
      ee += e * e;
      ey += e * d;
      yy += d * d;
    }
    const double spread = ee - e_sum * e_sum / n;
    Projection p;
    p.a = spread > 1e-14 * ee ? ey / spread : 0.0;
    p.level = mean_ - p.a * e_sum / n;
    p.sum_of_squares = std::max(0.0, yy - p.a * ey);
    return p;
  }

  const std::vector<double>& t() const { return t_; }

 private:
  std::vector<double> t_;
  std::span<const double> y_;
  double mean_ = 0.0;
};

double refine_by_golden_section(const DecayProblem& problem, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  double x1 = high - kGolden * (high - low), x2 = low + kGolden * (high - low);
  double f1 = problem.project(x1).sum_of_squares, f2 = problem.project(x2).sum_of_squares;
  for (int i = 0; i < 24; ++i) {
    if (f1 < f2) {
      high = x2;
      x2 = x1;
      f2 = f1;
      x1 = high - kGolden * (high - low);
      f1 = problem.project(x1).sum_of_squares;
    } else {
      low = x1;
      x1 = x2;
      f1 = f2;
      x2 = low + kGolden * (high - low);
      f2 = problem.project(x2).sum_of_squares;
    }
  }
  return 0.5 * (low + high);
}

/// Normal equations of (a, b, level) at a point; J'J, J'r and the sum of squares.
struct Normal {
  Eigen::Matrix3d jj = Eigen::Matrix3d::Zero();
  Eigen::Vector3d jr = Eigen::Vector3d::Zero();
  double sum_of_squares = 0.0;
};

Eigen::Vector3d jacobian_row(const Eigen::Vector3d& p, double t, double e) { return {e, -p[0] * t * e, 1.0}; }

Normal normal_equations(const std::vector<double>& t, std::span<const double> y, const Eigen::Vector3d& p) {
  Normal out;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double e = portable::exp(-p[1] * t[i]), r = y[i] - p[2] - p[0] * e;
    const Eigen::Vector3d j = jacobian_row(p, t[i], e);
    out.jj += j * j.transpose();
    out.jr += j * r;
    out.sum_of_squares += r * r;
  }
  return out;
}

/// 1 + 2 sum of the autocorrelations of the residuals up to the first that is not positive: by how much fewer
/// independent maxima there are than maxima.
double correlation_time(const std::vector<double>& residual, double sum_of_squares) {
  double time = 1.0;
  for (std::size_t lag = 1; sum_of_squares > 0.0 && lag <= residual.size() / 4; ++lag) {
    double product = 0.0;
    for (std::size_t i = lag; i < residual.size(); ++i) product += residual[i] * residual[i - lag];
    if (product <= 0.0) break;
    time += 2.0 * product / sum_of_squares;
  }
  return time;
}

Unexpected undetermined(std::string why, std::string hint) {
  return fail(ErrorCode::parse, "the maxima do not determine a decay: " + why, {}, std::move(hint));
}

}  // namespace

Result<DecayParameters> fit_decay(std::span<const double> t_s, std::span<const double> maxima_V,
                                  double u_min_V) {
  assert(t_s.size() == maxima_V.size());
  const std::size_t n = t_s.size();
  if (n < 6)
    return undetermined(std::to_string(n) + " of them, at least 6 are needed", "record more load cycles");
  if (!std::isfinite(u_min_V)) return undetermined("the level of the minima is not a number", "");
  for (std::size_t i = 0; i < n; ++i)
    if (!std::isfinite(t_s[i]) || !std::isfinite(maxima_V[i]) || std::fabs(maxima_V[i]) > 1e100)
      return undetermined("number " + std::to_string(i + 1) + " is not finite", "");

  const DecayProblem problem(t_s, maxima_V);
  const double span_s = *std::max_element(problem.t().begin(), problem.t().end());
  const auto [low, high] = std::minmax_element(maxima_V.begin(), maxima_V.end());
  if (!(*high > *low)) return undetermined("they are all equal", "");
  if (!(span_s > 0.0)) return undetermined("they share one instant", "");

  int best = 0;
  double best_sum = 0.0;
  const double step = (kLogFastest - kLogSlowest) / kGrid;
  for (int i = 0; i <= kGrid; ++i) {
    const double sum = problem.project(kLogSlowest + step * i).sum_of_squares;
    if (i == 0 || sum < best_sum) best = i, best_sum = sum;
  }
  const double around = kLogSlowest + step * best;
  const double log_b = refine_by_golden_section(problem, std::max(kLogSlowest, around - step),
                                                std::min(kLogFastest, around + step));
  const Projection start = problem.project(log_b);

  Eigen::Vector3d p(start.a, portable::exp(log_b), start.level);
  Normal at = normal_equations(problem.t(), maxima_V, p);
  for (int i = 0; i < 8; ++i) {  // golden section leaves b at half the digits; these steps bring the rest
    const Eigen::Vector3d next = p + at.jj.ldlt().solve(at.jr);
    if (!next.allFinite() || next[1] <= 0.0) break;
    const Normal trial = normal_equations(problem.t(), maxima_V, next);
    if (!(trial.sum_of_squares <= at.sum_of_squares)) break;
    const bool settled = std::fabs(next[1] - p[1]) <= 1e-13 * p[1];
    p = next;
    at = trial;
    if (settled) break;
  }

  const double b = p[1];
  if (b <= 1.05e-5 || b >= 0.95)
    return undetermined("the best rate, " + shortest(b) + " 1/s, is at the end of the range 1e-5 to 1 1/s",
                        "a decay needs maxima that fall and level off within the record");
  if (span_s * b < 0.1)
    return undetermined("they span " + shortest(span_s) + " s, less than a tenth of the time constant " +
                            shortest(1.0 / b) + " s",
                        "record for at least a third of the time constant");

  const Eigen::Matrix3d inverse = at.jj.inverse();
  if (!inverse.allFinite() || p[0] == 0.0) return undetermined("a, b and c cannot be told apart", "");
  std::vector<double> residual(n);
  const std::size_t blocks = std::min<std::size_t>(n, 20);
  Eigen::Matrix3d meat = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < blocks; ++k) {
    Eigen::Vector3d score = Eigen::Vector3d::Zero();
    for (std::size_t i = k * n / blocks; i < (k + 1) * n / blocks; ++i) {
      const double e = portable::exp(-b * problem.t()[i]);
      residual[i] = maxima_V[i] - p[2] - p[0] * e;
      score += jacobian_row(p, problem.t()[i], e) * residual[i];
    }
    meat += score * score.transpose();
  }
  const double block_count = static_cast<double>(blocks), count = static_cast<double>(n);
  const Eigen::Matrix3d from_blocks = inverse * meat * inverse * (block_count / (block_count - 3.0));
  const Eigen::Matrix3d ordinary =
      inverse * (at.sum_of_squares / (count - 3.0) * correlation_time(residual, at.sum_of_squares));
  const Eigen::Matrix3d& covariance = from_blocks(1, 1) > ordinary(1, 1) ? from_blocks : ordinary;

  DecayParameters out;
  const double first_s = *std::min_element(t_s.begin(), t_s.end());
  const double growth =
      portable::exp(std::min(700.0, b * first_s));  // a refers to t = 0, not to the first maximum
  out.a_V = p[0] * growth;
  out.b_per_s = b;
  out.c_V = p[2] - u_min_V;
  const double per_b = p[0] * first_s;
  out.u_a_V = growth * std::sqrt(std::max(0.0, covariance(0, 0) + 2.0 * per_b * covariance(0, 1) +
                                                   per_b * per_b * covariance(1, 1)));
  out.u_b_per_s = std::sqrt(covariance(1, 1));
  out.u_c_V = std::sqrt(covariance(2, 2));
  out.rmse_V = std::sqrt(at.sum_of_squares / count);
  out.n = static_cast<int>(n);
  return out;
}

DecayScales scales_of(const DecayParameters& fit, double f_Hz, double A_N) {
  return {fit.b_per_s / (0.0019 * f_Hz + 0.0056), fit.c_V / fit.a_V * (1.0 + 1.377 * A_N * A_N)};
}

}  // namespace forcegate
