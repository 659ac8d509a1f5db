// What the drive makes of a command: the force that the wheel's angle gives (or F_ref, without an angle) against the commanded one.

#include "hil/diagnose/candidates/command_channel.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "hil/base/quantile.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/record_input.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

constexpr double kFollows = 0.8;  // least squared correlation of force and command
constexpr std::array kSlowDrive_s = {0.1, 0.3};

const std::vector<double>& reached_N(const RecordInput& r) {
  return r.theta_rad.empty() || r.rig_force_N.empty() ? r.F_N : r.rig_force_N;
}

double squared_correlation(const RecordInput& r, const std::vector<double>& x, const std::vector<double>& y, double least_sd) {
  double n = 0.0, x1 = 0.0, y1 = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) {
      const double dx = x[i] - x[0], dy = y[i] - y[0];
      n += 1.0;
      x1 += dx;
      y1 += dy;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
    }
  if (n < 50.0) return 0.0;
  xx -= x1 * x1 / n;
  xy -= x1 * y1 / n;
  yy -= y1 * y1 / n;
  return xx > n * least_sd * least_sd && yy > 0.0 ? xy * xy / (xx * yy) : 0.0;
}

bool follows_command(const RecordInput& r, double range_N) {
  if (r.F_cmd_N.empty()) return false;
  const double least_sd = 0.01 * range_N;
  if (squared_correlation(r, r.F_cmd_N, reached_N(r), least_sd) > kFollows) return true;
  // a drive so slow that its phase hides the command follows it all the same
  const auto late = [&](double tau_s) {
    return squared_correlation(r, low_pass_channel(r, r.F_cmd_N, tau_s, r.F_cmd_N[0]), reached_N(r), least_sd) > kFollows;
  };
  return std::ranges::any_of(kSlowDrive_s, late);
}

// White noise of a row of what the drive makes of its command: the angle does not move in steps of the reference.
double drive_noise_N(const RecordInput& r) {
  const std::vector<double>& y = reached_N(r);
  std::vector<double> d;
  for (std::size_t i = 1; i + 1 < y.size(); ++i)
    d.push_back(std::abs(y[i - 1] - 2.0 * y[i] + y[i + 1] -
                         (r.F_cmd_N[i - 1] - 2.0 * r.F_cmd_N[i] + r.F_cmd_N[i + 1])));
  return deviation_of_magnitudes(std::move(d)) / std::sqrt(6.0);
}

// One record's drive: its force over the command and the command's rate.
struct DriveFit {
  double lag_s = 0.0;                     // 0: not seen beside the noise
  double before_N2 = 0.0, after_N2 = 0.0; // mean squares about the command's line
};

DriveFit fit_drive(const RecordInput& r) {
  constexpr double kPlain = 3.0;  // RMS of what the lag makes, over the noise of a row
  const std::vector<double>& y = reached_N(r);
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double n = 0.0, rates = 0.0, squares = 0.0;
  for (std::size_t i = 1; i + 1 < r.rows(); ++i) {
    const double span_s = r.t_s[i + 1] - r.t_s[i - 1];
    if (r.ok[i] == 0 || !(span_s > 0.0)) continue;
    const double rate = (r.F_cmd_N[i + 1] - r.F_cmd_N[i - 1]) / span_s;
    const Eigen::Vector3d x(1.0, r.F_cmd_N[i], rate);
    A += x * x.transpose();
    b += x * y[i];
    squares += y[i] * y[i];
    n += 1.0;
    rates += rate * rate;
  }
  DriveFit out;
  if (n < 50.0 || !(rates > 0.0)) return out;
  const Eigen::Vector3d c = A.ldlt().solve(b);
  const Eigen::Vector2d line = A.topLeftCorner<2, 2>().ldlt().solve(b.head<2>());
  const double lag_s = c[1] > 0.0 ? -c[2] / c[1] : 0.0;
  if (!(lag_s > 0.0 && lag_s * std::sqrt(rates / n) > kPlain * drive_noise_N(r))) return out;
  return {lag_s, std::max(0.0, squares - line.dot(b.head<2>())) / n, std::max(0.0, squares - c.dot(b)) / n};
}

// Where the records agree, and a reference that resolves 0.5 % of its range (Lebosse et al. 2011) would show what it makes.
LateDrive late_drive(const Workspace& w, const std::vector<std::size_t>& records) {
  constexpr double kAgree = 2.0, kLeast = 0.005 / 3.4641;  // of the force range: a step, RMS
  constexpr std::size_t kSeveral = 2;
  std::vector<double> lags;
  double before = 0.0, after = 0.0;
  for (const std::size_t k : records)
    if (const DriveFit fit = fit_drive(w.input.records[k]); fit.lag_s > 0.0) {
      lags.push_back(fit.lag_s);
      before += fit.before_N2;
      after += fit.after_N2;
    }
  if (lags.size() < kSeveral) return {};
  const auto n = static_cast<double>(lags.size());
  const auto [low, high] = quantiles(lags, 0.25, 0.75);
  const double least_N = kLeast * w.input.range_N;
  if (high > kAgree * low || before - after < n * least_N * least_N) return {};
  return {quantile(lags, 0.5), 0.5 * (high - low), std::sqrt(before / n), std::sqrt(after / n), static_cast<int>(lags.size())};
}

}  // namespace

void build_command_channel(Workspace& w, unsigned threads) {
  ResidualChannel& channel = w.command;
  channel = ResidualChannel{};
  channel.scale = w.input.range_N;
  channel.unit = std::string("N");
  channel.shown_in = ShownIn::command;
  for (std::size_t k = 0; k < w.input.records.size(); ++k)
    if (follows_command(w.input.records[k], w.input.range_N)) channel.record_of.push_back(k);
  w.has_command = channel.record_of.size() >= 2;
  if (!w.has_command) return;
  w.late_drive = late_drive(w, channel.record_of);
  MixedProblem& p = channel.problem;
  p.nz = 10;
  p.n_fixed = 3;
  // a drive follows late, differently in every manner of moving, and the angle's zero is known to a degree or two: no findings
  p.components = {{"drive_gain", 0.02, 0.002, 0.5},
                  {"drive_offset", 0.02, 0.001, 0.5},
                  {"angle_zero", 0.01, 0.002, 0.5},
                  {"drive_lag", 1.0, 1.0, 1.0},
                  {"drive_wander", 0.002, 3e-4, 0.5},
                  {"drive_curve", 0.02, 0.005, 0.5}};
  p.component_of_z = {0, 1, 2, 3, 3, 4, 4, 4, 5, 5};
  p.fixed_prior_sd = Eigen::Vector3d(10.0, 10.0, 0.03);
  const std::vector<std::string> only = {"motor"};
  list_candidates(w, EffectChannel::rig, false, channel, &only);
  fill_channel(w, channel, threads,
               [&](const RecordInput& r, const std::vector<std::size_t>& rows, Eigen::MatrixXd& Z,
                   std::vector<double>& y) {
                 const std::vector<double>& reached = reached_N(r);
                 for (std::size_t j = 0; j < rows.size(); ++j) {
                   const auto row = static_cast<Eigen::Index>(j);
                   Z(row, 0) = r.F_cmd_N[rows[j]] / channel.scale;
                   Z(row, 1) = 1.0;
                   if (!r.sin_theta.empty())
                     Z(row, 2) = w.rig_slope_N[r.index] * r.sin_theta[rows[j]] / channel.scale;
                   y.push_back(reached[rows[j]] / channel.scale);
                 }
                 add_drive_lag(r, r.F_cmd_N, rows, channel.scale, 3, Z);
                 add_waves(r, rows, 5, 3, Z);
                 // a machine without an angle is calibrated by somebody, to a curve
                 for (std::size_t j = 0; r.theta_rad.empty() && j < rows.size(); ++j) {
                   const double x = (r.F_cmd_N[rows[j]] - w.input.lowest_N) / channel.scale - 0.5;
                   Z(static_cast<Eigen::Index>(j), 8) = x * x;
                   Z(static_cast<Eigen::Index>(j), 9) = x * x * x;
                 }
               });
  for (std::size_t k = 0; k < channel.record_of.size(); ++k) {
    const RecordInput& r = w.input.records[channel.record_of[k]];
    if (r.theta_rad.empty()) continue;
    const double noise = drive_noise_N(r) / channel.scale;
    p.records[k].noise_variance = p.records[k].allowed_variance = noise * noise + 1e-8;
  }
}

}  // namespace forcegate::diagnose
