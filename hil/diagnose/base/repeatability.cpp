#include "hil/diagnose/base/repeatability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hil/model/decay_clock.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

constexpr int kShapes = 5, kWaves = 4, kSwing = 5, kFirstShape = 6;
constexpr int kFirstWave = kFirstShape + kShapes, kColumns = kFirstWave + kWaves;
constexpr double kShapeKnots_s[kShapes] = {3.0, 15.0, 60.0, 240.0, 900.0};
constexpr double kSwingPrior = 0.3;

// Hats on log time: the decay factor may bend away from one exponential, differently in each record.
std::array<double, kShapes> hats(double since_s) {
  static const std::array<double, kShapes> knot = [] {
    std::array<double, kShapes> out;
    for (int k = 0; k < kShapes; ++k) out[static_cast<std::size_t>(k)] = std::log(kShapeKnots_s[k] + 1.0);
    return out;
  }();
  std::array<double, kShapes> out{};
  if (since_s <= 0.0) return out;
  const double x = std::log(since_s + 1.0);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double left = k == 0 ? 0.0 : knot[k - 1];
    if (x <= knot[k])
      out[k] = std::clamp((x - left) / (knot[k] - left), 0.0, 1.0);
    else
      out[k] = k + 1 == out.size() ? 1.0 : std::clamp((knot[k + 1] - x) / (knot[k + 1] - knot[k]), 0.0, 1.0);
  }
  return out;
}

}  // namespace

void add_waves(const RecordInput& r, const std::vector<std::size_t>& rows, Eigen::Index first, int count, Eigen::MatrixXd& Z) {
  const bool is_block = !rows.empty() && r.t_s[rows.back()] - r.t_s[rows.front()] < 0.5 * r.duration_s;
  for (int k = 0; k < count; ++k) {
    if (!(r.duration_s > 60.0 * (k + 1))) continue;
    auto wave = Z.col(first + k);
    for (std::size_t j = 0; j < rows.size(); ++j) wave[static_cast<Eigen::Index>(j)] = std::cos(std::numbers::pi * (k + 1) * r.t_s[rows[j]] / r.duration_s);
    if (is_block) wave.array() -= wave.mean();  // which is the zero's
  }
}

void add_drive_lag(const RecordInput& r, const std::vector<double>& command_N, const std::vector<std::size_t>& rows, double scale,
                   Eigen::Index first, Eigen::MatrixXd& Z) {
  for (const double pole_s : {0.03, 0.1}) {
    const std::vector<double> late = low_pass_channel(r, command_N, pole_s, command_N[0]);
    for (std::size_t j = 0; j < rows.size(); ++j) Z(static_cast<Eigen::Index>(j), first) = (late[rows[j]] - command_N[rows[j]]) / scale;
    ++first;
  }
}

void set_repeatability(MixedProblem& problem, bool one_recording, bool zero_wanders, bool tells_swing) {
  problem.nz = kColumns;
  // F_min, swing and shape of the decay too: a decay in volts, another lowest force than the one that was found, a stretched
  // exponential are the same in all records, and no spread between them
  problem.n_fixed = kFirstShape + kShapes;
  problem.components = {{"gain", 0.02, 0.002, 0.5},  {"offset", 0.01, 0.001, 0.5},
                        {"log_b", 0.25, 0.05, 0.5},  {"log_q", 0.14, 0.03, 0.5},
                        {"F_min", 0.01, 0.001, 0.5}, {"swing", 0.03, 0.003, 0.5},
                        {"shape", 0.02, 0.003, 0.5}, {"wander", 0.002, 3e-4, 0.5}};
  // the record that is left out may be the only one that decays: the others do not tell of its decay, whatever is asked beside it
  if (!one_recording)
    for (std::size_t k = 2; k < problem.components.size(); ++k) problem.components[k].nuisance = problem.components[k].name != "wander";
  // blocks of one recording are the same machine, not touched in between: what changes there is the residual's business, and slow waves of
  // each block by itself would take what a slow lag does
  if (one_recording)
    for (std::size_t k = 0; k < problem.components.size(); ++k) {
      VarianceComponent& c = problem.components[k];
      const bool is_level = k == 0 || k == 1;
      c.nuisance = is_level;  // the part that is left out may be the only one that tells of the gain
      if (zero_wanders && !is_level) continue;
      c.prior_weight = zero_wanders ? 50.0 : 1e6;
      if (!zero_wanders) c.prior_sd = 1e-5;
      c.start_sd = c.prior_sd;
    }
  problem.component_of_z = {0, 1, 2, 3, 4, 5};
  for (int k = 0; k < kShapes; ++k) problem.component_of_z.push_back(6);
  for (int k = 0; k < kWaves; ++k) problem.component_of_z.push_back(7);
  constexpr double kNone = 0.005;
  problem.fixed_prior_sd = Eigen::VectorXd::Constant(problem.n_fixed, kNone);
  problem.fixed_prior_sd.head(6) << 10.0, 10.0, 1.0, 1.0, kNone, tells_swing ? kSwingPrior : kNone;
}

bool tells_swing(const MixedFit& fit) {
  constexpr double kOfPrior = 0.5;
  return fit.covariance(kSwing, kSwing) < std::pow(kOfPrior * kSwingPrior, 2);
}

void size_swing(MixedProblem& problem) {
  const MixedFit fit = fit_mixed(problem, {});
  if (!fit.valid) return;
  const double size = std::sqrt(std::pow(fit.coefficient[kSwing], 2) + std::max(0.0, fit.covariance(kSwing, kSwing)));
  problem.plain_prior_sd = problem.fixed_prior_sd;
  problem.plain_prior_sd[kSwing] = std::min(problem.fixed_prior_sd[kSwing], size);
}

Eigen::MatrixXd repeatability_columns(const Workspace& w, std::size_t index,
                                      const std::vector<std::size_t>& rows) {
  const RecordInput& r = w.input.records[index];
  Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), kColumns);
  const double g = w.gain_V_per_N / w.input.U_range_V;
  const double b = w.law.decay_rate_per_s(r.f_Hz) * std::exp(w.shifts[index].log_b);
  const double q = w.law.depth_ratio(r.A_N) * std::exp(w.shifts[index].log_q);
  const DecayClock clock(r, w.law.loading_share);
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const std::size_t i = rows[j];
    const auto row = static_cast<Eigen::Index>(j);
    const double since = clock(i), swing = r.F_N[i] - r.F_min_N;
    const bool decays = r.dynamic && w.law.decays && since > 0.0;
    const double e = decays ? std::exp(-b * since) : 1.0, D = decays ? (e + q) / (1.0 + q) : 1.0;
    Z(row, 0) = g * (r.F_min_N + D * swing);
    Z(row, 1) = 1.0;
    if (r.dynamic) {
      if (decays) {
        Z(row, 2) = g * swing * (-b * since * e) / (1.0 + q);
        Z(row, 3) = g * swing * q * (1.0 - e) / ((1.0 + q) * (1.0 + q));
        Z(row, 4) = (1.0 - D) * g * w.input.range_N;
        // laws a(A), c(A) in volts do not start at the static gain: the swing has a size of its own
        Z(row, kSwing) = g * D * swing;
      }
      const auto shape = hats(since);
      for (int k = 0; k < kShapes; ++k)
        Z(row, kFirstShape + k) = g * swing * shape[static_cast<std::size_t>(k)];
    }
  }
  add_waves(r, rows, kFirstWave, kWaves, Z);
  return Z;
}

double bend_of(const MixedFit& fit, std::size_t k, double since_s) {
  const auto shape = hats(since_s);
  double out = 0.0;
  for (int j = 0; j < kShapes; ++j) out += shape[static_cast<std::size_t>(j)] * (fit.coefficient[kFirstShape + j] + fit.zeta[k][kFirstShape + j]);
  return out;
}

double wander_of(const MixedFit& fit, std::size_t k) { return std::sqrt(0.5) * fit.zeta[k].segment(kFirstWave, kWaves).norm(); }

double wander_on_rows(const ResidualChannel& channel, const MixedFit& fit, std::size_t k) {
  const Eigen::VectorXd wander = channel.rows[k].matrix.middleCols(kFirstWave, kWaves) * fit.zeta[k].segment(kFirstWave, kWaves);
  return wander.size() == 0 ? 0.0 : std::sqrt(wander.squaredNorm() / static_cast<double>(wander.size()));
}

double wander_range_of(const MixedFit& fit, std::size_t k) {
  constexpr int kPlaces = 64;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (int i = 0; i <= kPlaces; ++i) {
    double at = 0.0;
    for (int j = 0; j < kWaves; ++j) at += fit.zeta[k][kFirstWave + j] * std::cos(std::numbers::pi * (j + 1) * i / kPlaces);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

void follow_course(const MixedFit& fit, std::size_t k, double loading_share, RecordInput& r) {
  constexpr double kLeastGain = 0.1;
  const double gain = fit.coefficient[0] + fit.zeta[k][0], swing = fit.coefficient[kSwing] + fit.zeta[k][kSwing];
  if (!r.dynamic || !(gain > kLeastGain)) return;
  const DecayClock clock(r, loading_share);
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (const double since_s = clock(i); since_s > 0.0)
      r.decay[i] = std::max(0.0, ((gain + swing) * r.decay[i] + bend_of(fit, k, since_s)) / gain);
}

}  // namespace forcegate::diagnose
