// The third witness: the force that the rig's own law predicts from the wheel's angle or from the command.

#include "hil/diagnose/candidates/rig_law.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/base/parallel.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/candidates/command_jumps.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/record_input.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

// Shares of the force's variance that the angle or the command explains where the rig makes the force of it.
constexpr double kOfWheel = 0.9, kOfCommand = 0.5;
// A shorter record has a zero, and no course of it.
constexpr double kShortestCourse_s = 15.0;

// k (preload + eccentricity (1 - cos theta)) without k: the zero of the reference can be seen against it.
std::vector<double> spring_travel_mm(const RecordInput& r) {
  std::vector<double> out;
  if (r.cos_theta.empty() || !std::isfinite(r.eccentricity_mm) || !std::isfinite(r.preload_mm)) return out;
  for (const double c : r.cos_theta) out.push_back(r.preload_mm + r.eccentricity_mm * (1.0 - c));
  return out;
}

struct Line {
  double n = 0.0, mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

// Rows whose force is above `least_N` only: where the contact is open the force stands at zero whatever the wheel does.
Line line_of(const std::vector<double>& x, const RecordInput& r, double least_N) {
  Line out;
  const auto counts = [&](std::size_t i) { return r.ok[i] != 0 && r.F_N[i] > least_N; };
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (counts(i)) {
      out.mean_x += x[i];
      out.mean_y += r.F_N[i];
      out.n += 1.0;
    }
  if (out.n < 1.0) return out;
  out.mean_x /= out.n;
  out.mean_y /= out.n;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (counts(i)) {
      out.xx += (x[i] - out.mean_x) * (x[i] - out.mean_x);
      out.xy += (x[i] - out.mean_x) * (r.F_N[i] - out.mean_y);
      out.yy += (r.F_N[i] - out.mean_y) * (r.F_N[i] - out.mean_y);
    }
  return out;
}

// The command as the drive follows it: a servo is late by what it is late by, and a shift is more than its slope where a foot is put down.
std::vector<double> command_as_followed(const RecordInput& r, double least_N) {
  constexpr double kLatest_s = 0.25, kStep_s = 0.005;
  std::vector<double> best = r.F_cmd_N, late(r.rows());
  double most = 0.0;
  for (double shift_s = 0.0; shift_s <= kLatest_s; shift_s += kStep_s) {
    std::size_t from = 0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double at = r.t_s[i] - shift_s;
      while (from + 2 < r.rows() && r.t_s[from + 1] < at) ++from;
      const double share = r.rows() < 2 ? 0.0 : std::clamp((at - r.t_s[from]) / std::max(1e-9, r.t_s[from + 1] - r.t_s[from]), 0.0, 1.0);
      late[i] = r.F_cmd_N[from] + share * (r.F_cmd_N[std::min(from + 1, r.rows() - 1)] - r.F_cmd_N[from]);
    }
    const Line line = line_of(late, r, least_N);
    const double explained = line.xx > 0.0 && line.yy > 0.0 ? line.xy * line.xy / (line.xx * line.yy) : 0.0;
    if (explained <= most) continue;
    most = explained;
    best = late;
  }
  return best;
}

// A command that runs through its range from row to row does not tell when the drive was where.
bool is_resolved(const std::vector<double>& command_N) {
  constexpr double kMost = 0.1;  // half the mean square from row to row, of the variance: a sine of fourteen rows
  double n = 0.0, mean = 0.0, square = 0.0, steps = 0.0;
  for (std::size_t i = 0; i < command_N.size(); ++i) {
    n += 1.0;
    const double d = command_N[i] - mean;
    mean += d / n;
    square += d * (command_N[i] - mean);
    if (i > 0) steps += (command_N[i] - command_N[i - 1]) * (command_N[i] - command_N[i - 1]);
  }
  return 0.5 * steps < kMost * square;
}

// One stiffness for all records whose geometry is declared, from movements within records; 0 when they do not agree.
double stiffness_N_per_mm(const CampaignInput& input) {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  int n = 0, with_angle = 0;
  for (const RecordInput& r : input.records) {
    // a rest below the contact says nothing of the spring, and nothing against it
    if (r.cos_theta.empty() || line_of(r.cos_theta, r, kOpenContact * input.range_N).n < 50.0) continue;
    ++with_angle;
    const std::vector<double> x = spring_travel_mm(r);
    if (x.empty()) continue;
    const Line line = line_of(x, r, kOpenContact * input.range_N);
    ++n;
    xx += line.xx / line.n;
    xy += line.xy / line.n;
    yy += line.yy / line.n;
  }
  if (n < 3 || n < with_angle || !(xx > 0.0) || xy * xy < kOfWheel * xx * yy || xy < 0.0) return 0.0;
  return xy / xx;
}

// F_ref less the rig's law over the record's time: its mean, and where it lasts long enough slow waves; what goes with the spring's
// force is none of it.
std::vector<double> zero_over_rig_N(const RecordInput& r, double least_N) {
  constexpr double kFewest = 50.0, kWave_s = 10.0;
  constexpr int kMostWaves = 8, kOfSpring = 2;
  const int waves = r.duration_s > kShortestCourse_s ? std::clamp(static_cast<int>(r.duration_s / kWave_s), 1, kMostWaves) : 0;
  // cos pi (k + 1) t / T by Chebyshev's recurrence
  std::array<double, kMostWaves> wave{};
  const auto set_waves = [&](double t_s) {
    const double first = std::cos(std::numbers::pi * t_s / r.duration_s);
    double before = 1.0, now = first;
    for (int k = 0; k < waves; ++k) {
      wave[static_cast<std::size_t>(k)] = now;
      now = 2.0 * first * now - std::exchange(before, now);
    }
  };
  double n = 0.0, mean_d = 0.0, mean_L = 0.0, widest = 0.0;
  const auto counts = [&](std::size_t i) { return r.ok[i] != 0 && r.F_N[i] > least_N; };
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (counts(i)) {
      n += 1.0;
      mean_d += r.F_N[i] - r.rig_force_N[i];
      mean_L += r.rig_force_N[i];
    }
  if (n < kFewest) return {};
  mean_d /= n;
  mean_L /= n;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (counts(i)) widest = std::max(widest, std::abs(r.rig_force_N[i] - mean_L));
  // 1, L, L^2, waves
  const int columns = 1 + kOfSpring + waves;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(columns, columns);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(columns), x(columns);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (!counts(i)) continue;
    const double L = widest > 0.0 ? (r.rig_force_N[i] - mean_L) / widest : 0.0;
    x[0] = 1.0;
    x[1] = L;
    x[2] = L * L;
    set_waves(r.t_s[i]);
    for (int k = 0; k < waves; ++k) x[1 + kOfSpring + k] = wave[static_cast<std::size_t>(k)];
    A += x * x.transpose();
    y += (r.F_N[i] - r.rig_force_N[i] - mean_d) * x;
  }
  // a ramp up and down is nearly a wave: of the two that would cancel both stay small
  constexpr double kRidge = 0.01;
  A.diagonal().array() += kRidge * n;
  const Eigen::VectorXd c = A.ldlt().solve(y);
  double mean_wave = 0.0;
  std::vector<double> out(r.rows(), 0.0);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    set_waves(r.t_s[i]);
    for (int k = 0; k < waves; ++k) out[i] += c[1 + kOfSpring + k] * wave[static_cast<std::size_t>(k)];
    mean_wave += counts(i) ? out[i] / n : 0.0;
  }
  for (double& zero : out) zero += mean_d - mean_wave;
  return out;
}

// Of one law against the middle one of all records: what all have in common is nobody's drift. A line of a record's own has taken its mean away.
RigShows find_zeros(CampaignInput& input, bool one_law, unsigned threads) {
  parallel_for(input.records.size(), threads, [&](std::size_t k) {
    RecordInput& r = input.records[k];
    r.rig_zero_N.clear();
    if (!r.rig_force_N.empty()) r.rig_zero_N = zero_over_rig_N(r, kOpenContact * input.range_N);
  });
  if (!one_law) {
    const auto seen = std::ranges::count_if(input.records, [](const RecordInput& r) { return !r.rig_zero_N.empty() && r.duration_s > kShortestCourse_s; });
    return 2 * static_cast<std::size_t>(seen) >= input.records.size() ? RigShows::course_within_records : RigShows::nothing;
  }
  std::vector<double> middle;
  for (const RecordInput& r : input.records)
    if (!r.rig_zero_N.empty()) middle.push_back(r.rig_zero_N[r.rows() / 2]);
  const double common = middle.empty() ? 0.0 : quantile(std::move(middle), 0.5);
  for (RecordInput& r : input.records)
    for (double& zero : r.rig_zero_N) zero -= common;
  return RigShows::zero_of_records;
}

}  // namespace

void find_rig_law(Workspace& w, std::vector<std::size_t>& records, unsigned threads) {
  const double stiffness = stiffness_N_per_mm(w.input);
  w.rig_slope_N.assign(w.input.records.size(), 0.0);
  for (std::size_t k = 0; k < w.input.records.size(); ++k) {
    RecordInput& r = w.input.records[k];
    r.rig_force_N.clear();
    if (stiffness > 0.0) {
      std::vector<double> x = spring_travel_mm(r);
      if (x.empty()) continue;
      for (double& v : x) v *= stiffness;
      r.rig_force_N = std::move(x);
      w.rig_slope_N[k] = stiffness * r.eccentricity_mm;
      records.push_back(k);
      continue;
    }
    // the geometry is not known: the line of the record itself gives a force in newtons, and takes its zero away
    std::vector<double> s;
    if (!r.cos_theta.empty())
      for (const double c : r.cos_theta) s.push_back(1.0 - c);
    else if (w.input.has_spindle && !r.theta_rad.empty())
      s = r.theta_rad;
    else if (!r.F_cmd_N.empty() && is_resolved(r.F_cmd_N))
      s = command_as_followed(r, kOpenContact * w.input.range_N);
    else
      continue;
    const Line line = line_of(s, r, kOpenContact * w.input.range_N);
    // without a clear linear relation the coordinate is not the rig's: a crank or a joint has an angle too, and a hand or a foot makes its force
    const double least = r.theta_rad.empty() ? kOfCommand : kOfWheel;
    if (line.n < 50.0 || !(line.xx > 0.0) || line.xy * line.xy < least * line.xx * line.yy ||
        std::sqrt(line.yy / line.n) < 0.01 * w.input.range_N)
      continue;
    for (double v : s) r.rig_force_N.push_back(line.mean_y + line.xy / line.xx * (v - line.mean_x));
    if (!r.cos_theta.empty()) w.rig_slope_N[k] = line.xy / line.xx;
    records.push_back(k);
  }
  w.rig_shows = find_zeros(w.input, stiffness > 0.0, threads);
}

void build_rig_channel(Workspace& w, unsigned threads) {
  w.has_rig = false;
  ResidualChannel& channel = w.rig;
  channel = ResidualChannel{};
  channel.scale = w.input.range_N;
  channel.unit = std::string("N");
  channel.shown_in = ShownIn::rig;
  find_rig_law(w, channel.record_of, threads);
  if (channel.record_of.size() < 2) return;
  w.has_rig = true;

  MixedProblem& p = channel.problem;
  p.nz = 4 + 3 + 2;
  p.n_fixed = 4;
  // a command reaches the force through a motor, a reference reads the force a few milliseconds late, and the angle's zero is
  // known to a degree or two: no findings. Both are the same in all records: what differs from record to record is a play. Slow records
  // say nothing of a lag
  p.components = {{"rig_gain", 0.02, 0.002, 0.5},      {"rig_offset", 0.02, 0.001, 0.5},
                  {"reference_lag", 0.01, 0.01, 50.0, true, true}, {"angle_zero", 5e-4, 5e-4, 50.0, true, true},
                  {"rig_wander", 0.002, 3e-4, 0.5},    {"motor_lag", 1.0, 1.0, 1.0}};
  p.component_of_z = {0, 1, 2, 3, 4, 4, 4, 5, 5};
  p.fixed_prior_sd = Eigen::Vector4d(10.0, 10.0, 2.0, 0.03);
  list_candidates(w, EffectChannel::rig, false, channel);
  fill_channel(w, channel, threads,
               [&](const RecordInput& r, const std::vector<std::size_t>& rows, Eigen::MatrixXd& Z,
                   std::vector<double>& y) {
                 const double slope = w.rig_slope_N[r.index] / channel.scale;
                 const std::vector<double> late_N = w.input.has_spindle && !r.theta_rad.empty() ? low_pass_channel(r, r.rig_force_N, kLateAngle_s, r.rig_force_N[0]) : std::vector<double>();
                 for (std::size_t j = 0; j < rows.size(); ++j) {
                   const auto row = static_cast<Eigen::Index>(j);
                   Z(row, 0) = r.rig_force_N[rows[j]] / channel.scale;
                   Z(row, 1) = 1.0;
                   if (slope != 0.0) {
                     Z(row, 2) = slope * (r.cos_theta[rows[j]] - r.late_cos_theta[rows[j]]);
                     Z(row, 3) = slope * r.sin_theta[rows[j]];
                   }
                   if (!late_N.empty()) Z(row, 2) = (late_N[rows[j]] - r.rig_force_N[rows[j]]) / channel.scale;
                   y.push_back(r.F_N[rows[j]] / channel.scale);
                 }
                 add_waves(r, rows, 4, 3, Z);
                 if (r.theta_rad.empty())
                   add_drive_lag(r, r.rig_force_N, rows, channel.scale, 7, Z);
               },
               [&](const RecordInput& r, std::vector<std::size_t>& rows) {
                 if (r.theta_rad.empty()) leave_out_command_jumps(r, w.input.range_N, rows);
               });
}

}  // namespace forcegate::diagnose
