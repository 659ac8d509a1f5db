#include "hil/model/impedance/two_variable.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace forcegate::impedance {
namespace {

constexpr std::size_t kFewest = 6;

using Errors = std::vector<std::array<double, 3>>;  // (F/F_max)^2, error by conductance, by capacitance

// S_0 + S_1 x by least squares of the products of errors on x, kept such that both ends are valid variances.
ErrorCovariance covariance_of(const Errors& errors, double loadings) {
  ErrorCovariance out;
  out.loadings = loadings;
  const auto fit = [&](int i, int k, double& zero, double& full) {
    double n = 0, sx = 0, sxx = 0, sy = 0, sxy = 0;
    for (const auto& e : errors) {
      const double y = e[static_cast<std::size_t>(1 + i)] * e[static_cast<std::size_t>(1 + k)];
      n += 1, sx += e[0], sxx += e[0] * e[0], sy += y, sxy += e[0] * y;
    }
    full = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    zero = (sy - full * sx) / n;
  };
  fit(0, 0, out.at_zero[0], out.at_full[0]);
  fit(0, 1, out.at_zero[1], out.at_full[1]);
  fit(1, 1, out.at_zero[2], out.at_full[2]);
  return out;
}

// Positive variances, correlation within +-0.95, everywhere on the range.
void make_valid(ErrorCovariance& s) {
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
    const double total = s.at_zero[i] + s.at_full[i], least = std::max(0.1 * std::abs(total), 1e-6);
    s.at_zero[i] = std::clamp(s.at_zero[i], least, std::max(least, 3.0 * std::abs(total)));
    s.at_full[i] = std::max(s.at_full[i], 0.1 * s.at_zero[i]);
  }
  const auto bounded = [](double cross, double a, double b) {
    return std::clamp(cross, -0.95 * std::sqrt(a * b), 0.95 * std::sqrt(a * b));
  };
  s.at_zero[1] = bounded(s.at_zero[1], s.at_zero[0], s.at_zero[2]);
  s.at_full[1] = bounded(s.at_full[1], s.at_full[0], s.at_full[2]);
}

}  // namespace

TwoVariableModel::Parabola TwoVariableModel::fit_parabola(const std::vector<ForceReading>& readings,
                                                          bool capacitance) {
  const auto x_of = [capacitance](const ForceReading& r) {
    return capacitance ? r.capacitance_F : r.output_V;
  };
  const auto [low, high] = std::minmax_element(
      readings.begin(), readings.end(), [&](const auto& a, const auto& b) { return x_of(a) < x_of(b); });
  Parabola p;
  p.centre = 0.5 * (x_of(*low) + x_of(*high));
  p.scale = std::max(0.5 * (x_of(*high) - x_of(*low)), 1e-300);
  Eigen::MatrixXd X(static_cast<Eigen::Index>(readings.size()), 3);
  Eigen::VectorXd y(X.rows());
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const ForceReading& r = readings[static_cast<std::size_t>(i)];
    const double t = (x_of(r) - p.centre) / p.scale;
    X.row(i) << 1.0, t, t * t;
    y[i] = r.force_N;
  }
  const Eigen::Vector3d a = X.colPivHouseholderQr().solve(y);
  p.a = {a[0], a[1], a[2]};
  return p;
}

ForceEstimate TwoVariableModel::estimate(double output_V, double capacitance_F) const {
  const double by_g = from_conductance_.force_N(output_V), by_c = from_capacitance_.force_N(capacitance_F);
  const double at = std::clamp(0.5 * (by_g + by_c) / full_N_, 0.0, 1.0), x = at * at;
  std::array<double, 3> s;
  for (std::size_t i = 0; i < 3; ++i) s[i] = covariance_.at_zero[i] + covariance_.at_full[i] * x;
  const double spread = s[0] + s[2] - 2.0 * s[1];
  const double weight = std::clamp((s[2] - s[1]) / spread, 0.0, 1.0);  // of the conductance
  const double variance =
      weight * weight * s[0] + 2.0 * weight * (1.0 - weight) * s[1] + (1.0 - weight) * (1.0 - weight) * s[2];
  return {weight * by_g + (1.0 - weight) * by_c, std::sqrt(variance)};
}

Result<std::vector<TwoVariableModel>> fit_two_variable(
    const std::vector<std::vector<std::vector<ForceReading>>>& sensors, double pool) {
  std::vector<TwoVariableModel> models(sensors.size());
  std::vector<Errors> errors(sensors.size());
  Errors all;
  double loadings = 0.0;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const auto& own = sensors[s];
    if (own.size() < 2)
      return fail(ErrorCode::parse,
                  "a two-variable model needs two loadings of each sensor, to see what a new loading does");
    std::vector<ForceReading> joined;
    for (const auto& loading : own) joined.insert(joined.end(), loading.begin(), loading.end());
    if (joined.size() < kFewest * own.size())
      return fail(ErrorCode::parse, "a two-variable model needs six levels in each loading");
    TwoVariableModel& m = models[s];
    m.from_conductance_ = TwoVariableModel::fit_parabola(joined, false);
    m.from_capacitance_ = TwoVariableModel::fit_parabola(joined, true);
    m.full_N_ = 0.0;
    for (const ForceReading& r : joined) m.full_N_ = std::max(m.full_N_, r.force_N);
    // n - 1 loadings predict the n-th with a variance of n/(n-1) of a loading's; n will predict the next with (n+1)/n.
    const double n = static_cast<double>(own.size()), shrink = std::sqrt((n + 1.0) / n * (n - 1.0) / n);
    for (std::size_t left = 0; left < own.size(); ++left) {
      std::vector<ForceReading> others;
      for (std::size_t l = 0; l < own.size(); ++l)
        if (l != left) others.insert(others.end(), own[l].begin(), own[l].end());
      const auto by_g = TwoVariableModel::fit_parabola(others, false),
                 by_c = TwoVariableModel::fit_parabola(others, true);
      for (const ForceReading& r : own[left]) {
        const double share = r.force_N / m.full_N_;
        errors[s].push_back({share * share, shrink * (by_g.force_N(r.output_V) - r.force_N),
                             shrink * (by_c.force_N(r.capacitance_F) - r.force_N)});
      }
    }
    all.insert(all.end(), errors[s].begin(), errors[s].end());
    loadings += n - 1.0;
  }
  const ErrorCovariance of_all = covariance_of(all, loadings);
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const double n = static_cast<double>(sensors[s].size()) - 1.0;
    ErrorCovariance own = covariance_of(errors[s], n + pool);
    for (std::size_t i = 0; i < 3; ++i) {
      own.at_zero[i] = (n * own.at_zero[i] + pool * of_all.at_zero[i]) / (n + pool);
      own.at_full[i] = (n * own.at_full[i] + pool * of_all.at_full[i]) / (n + pool);
    }
    make_valid(own);
    models[s].covariance_ = own;
  }
  return models;
}

}  // namespace forcegate::impedance
