#include "hil/model/impedance/network.h"

#include <Eigen/Dense>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>
#include <vector>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"

namespace forcegate::impedance {
namespace {

constexpr double kDecay =
    0.01;  // a weight of 1 costs as much as one residual of 1 % of the force's deviation
constexpr int kMostEvaluations = 400;

double hyperbolic_tangent(double x) {
  if (std::abs(x) > 20.0) return x > 0.0 ? 1.0 : -1.0;
  const double e = portable::exp(2.0 * x);
  return (e - 1.0) / (e + 1.0);
}

struct Sample {
  double v, c, f;
};

struct Residuals {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const std::vector<Sample>& samples;
  int inputs() const { return static_cast<int>(Network::kWeights); }
  int values() const { return static_cast<int>(samples.size() + Network::kWeights); }

  int operator()(const Eigen::VectorXd& w, Eigen::VectorXd& r) const {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& s = samples[i];
      r[static_cast<Eigen::Index>(i)] = w[6] + w[7] * hyperbolic_tangent(w[0] + w[1] * s.v + w[2] * s.c) +
                                        w[8] * hyperbolic_tangent(w[3] + w[4] * s.v + w[5] * s.c) - s.f;
    }
    r.tail(inputs()) = kDecay * w;
    return 0;
  }

  int df(const Eigen::VectorXd& w, Eigen::MatrixXd& J) const {
    J.setZero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Sample& s = samples[i];
      const auto row = static_cast<Eigen::Index>(i);
      const double h1 = hyperbolic_tangent(w[0] + w[1] * s.v + w[2] * s.c),
                   h2 = hyperbolic_tangent(w[3] + w[4] * s.v + w[5] * s.c);
      const double d1 = w[7] * (1.0 - h1 * h1), d2 = w[8] * (1.0 - h2 * h2);
      J.row(row) << d1, d1 * s.v, d1 * s.c, d2, d2 * s.v, d2 * s.c, 1.0, h1, h2;
    }
    J.bottomRows(inputs()).diagonal().setConstant(kDecay);
    return 0;
  }
};

struct Scaling {
  double mean = 0, scale = 1;
};
template <class Get>
Scaling scaling_of(std::span<const ForceReading> readings, Get get) {
  double mean = 0, squares = 0;
  for (const ForceReading& r : readings) mean += get(r) / static_cast<double>(readings.size());
  for (const ForceReading& r : readings) squares += (get(r) - mean) * (get(r) - mean);
  return {mean, std::sqrt(squares / static_cast<double>(readings.size()))};
}

}  // namespace

double Network::force_N(double output_V, double capacitance_F) const {
  const double v = (output_V - mean_V) / scale_V, c = (capacitance_F - mean_F) / scale_F;
  const auto& w = weights;
  const double y = w[6] + w[7] * hyperbolic_tangent(w[0] + w[1] * v + w[2] * c) +
                   w[8] * hyperbolic_tangent(w[3] + w[4] * v + w[5] * c);
  return mean_N + scale_N * y;
}

Result<Network> train_network(std::span<const ForceReading> readings, std::uint64_t seed, int starts) {
  if (readings.size() < 2 * Network::kWeights)
    return fail(ErrorCode::parse, "a network of nine weights needs at least 18 readings");
  const Scaling v = scaling_of(readings, [](const ForceReading&r) { return r.output_V; }),
                c = scaling_of(readings, [](const ForceReading&r) { return r.capacitance_F; }),
                f = scaling_of(readings, [](const ForceReading&r) { return r.force_N; });
  if (!(v.scale > 0.0) || !(c.scale > 0.0) || !(f.scale > 0.0))
    return fail(ErrorCode::parse, "the readings that shall train a network do not vary");
  Network out{.mean_V = v.mean,
              .scale_V = v.scale,
              .mean_F = c.mean,
              .scale_F = c.scale,
              .mean_N = f.mean,
              .scale_N = f.scale};
  std::vector<Sample> samples;
  for (const ForceReading& r : readings)
    samples.push_back({(r.output_V - v.mean) / v.scale, (r.capacitance_F - c.mean) / c.scale,
                       (r.force_N - f.mean) / f.scale});
  Rng rng(seed, "network");
  double best = INFINITY;
  for (int start = 0; start < starts; ++start) {
    Eigen::VectorXd w(Network::kWeights);
    for (Eigen::Index k = 0; k < w.size(); ++k) w[k] = rng.uniform(-1.0, 1.0);
    Residuals residuals{samples};
    Eigen::LevenbergMarquardt<Residuals> solver(residuals);
    solver.parameters.maxfev = kMostEvaluations;
    solver.parameters.ftol = solver.parameters.xtol = 1e-9;
    solver.minimize(w);
    const double cost = solver.fvec.squaredNorm();
    if (!(cost < best)) continue;
    best = cost;
    for (std::size_t k = 0; k < Network::kWeights; ++k) out.weights[k] = w[static_cast<Eigen::Index>(k)];
  }
  double squares = 0.0;
  for (const ForceReading& r : readings)
    squares += std::pow(out.force_N(r.output_V, r.capacitance_F) - r.force_N, 2);
  out.training_rmse_N = std::sqrt(squares / static_cast<double>(readings.size()));
  return out;
}

}  // namespace forcegate::impedance
