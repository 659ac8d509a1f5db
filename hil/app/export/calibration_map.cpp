#include "hil/app/export/calibration_map.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hil/gate/case_result.h"
#include "hil/trace/decay_fit.h"

namespace forcegate {
namespace {

constexpr double kRow_s = 0.02;
constexpr int kFast = 4;  // samples of the full-rate force in a row
constexpr double kAround[] = {0.7, 1.0, 1.3};

// A record as the model sees it, of a force that is known everywhere.
template <class Force>
RecordInput synthetic(const Force& force_N, double duration_s) {
  RecordInput r;
  r.name = "simulated";
  r.row_step_s = kRow_s;
  r.duration_s = duration_s;
  const auto n = static_cast<std::size_t>(duration_s / kRow_s);
  for (std::size_t i = 0; i < n; ++i) {
    double F = 0.0, t = 0.0;
    r.row_begin.push_back(static_cast<std::uint32_t>(r.fast_t_s.size()));
    for (int k = 0; k < kFast; ++k) {
      r.fast_t_s.push_back(kRow_s * (static_cast<double>(i) + (k + 0.5) / kFast));
      r.fast_F_N.push_back(force_N(r.fast_t_s.back()));
      t += r.fast_t_s.back() / kFast;
      F += r.fast_F_N.back() / kFast;
    }
    r.t_s.push_back(t);
    r.F_N.push_back(F);
  }
  r.row_begin.push_back(static_cast<std::uint32_t>(r.fast_t_s.size()));
  r.ok.assign(n, 1);
  r.U_V.assign(n, 0.0);
  r.rate_N_per_s.assign(n, 0.0);
  r.travel_N.assign(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) r.rate_N_per_s[i] = (r.F_N[i + 1] - r.F_N[i - 1]) / (2.0 * kRow_s);
  for (std::size_t i = 1; i < n; ++i) r.travel_N[i] = r.travel_N[i - 1] + std::abs(r.F_N[i] - r.F_N[i - 1]);
  return r;
}

// One temperature throughout: effects of the library are zero there, at the model's own or at the mean of the campaign, which is this record (its
// decay set).
void set_temperature(CampaignInput& input, RecordInput& r, double temperature_C) {
  if (!std::isfinite(temperature_C)) return;
  r.temp_C.assign(r.rows(), temperature_C);
  input.has_temp = true;
  input.records = {r};
}

Result<void> sweeps(const Model& model, CampaignInput input, const PlanCalibration& c, double temperature_C,
                    CalibrationMap& map) {
  const auto force = [&](double t) {
    const double phase = std::fmod(t / c.sweep_s, 1.0);
    return c.sweep_low_N + (c.sweep_high_N - c.sweep_low_N) * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase);
  };
  RecordInput r = synthetic(force, c.sweep_s * c.sweeps);
  set_decay(r, model.law);
  set_temperature(input, r, temperature_C);
  FORCEGATE_TRY(const std::vector<double> U, model_output_V(model, CampaignInFrame(model.frame, std::move(input)), r));
  // F = alpha (G U + F0) + beta by least squares, as the calibration does it
  double su = 0, sf = 0, suu = 0, suf = 0;
  const double n = static_cast<double>(r.rows());
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const double u = model.law.gain_N_per_V * U[i] + model.law.offset_N;
    su += u, sf += r.F_N[i], suu += u * u, suf += u * r.F_N[i];
  }
  map.alpha = (suf / n - su * sf / (n * n)) / (suu / n - su * su / (n * n));
  map.beta_N = sf / n - map.alpha * su / n;
  return {};
}

struct Identified {
  double b_scale = 0.0, q_scale = 0.0;
};

Result<Identified> identify(const Model& model, const CampaignInFrame& input, RecordInput& r,
                            const StimulusFacts& facts, const BaseLaw& law) {
  Model changed = model;
  changed.law = law;
  set_decay(r, law);
  FORCEGATE_TRY(const std::vector<double> U, model_output_V(changed, input, r));
  std::vector<double> t_s, maxima_V, minima_V;
  for (std::size_t i = 1; i + 1 < r.rows(); ++i) {
    if (r.t_s[i] < facts.excitation_start_s) continue;
    const double before = r.F_N[i] - r.F_N[i - 1], after = r.F_N[i + 1] - r.F_N[i];
    if (before > 0.0 && after <= 0.0 && r.F_N[i] > facts.mean_N) {
      t_s.push_back(r.t_s[i] - facts.excitation_start_s);
      maxima_V.push_back(U[i]);
    } else if (before < 0.0 && after >= 0.0 && r.F_N[i] < facts.mean_N) {
      minima_V.push_back(U[i]);
    }
  }
  double u_min_V = 0.0;
  for (double v : minima_V) u_min_V += v / static_cast<double>(minima_V.size());
  FORCEGATE_TRY(const DecayParameters fit, fit_decay(t_s, maxima_V, u_min_V));
  BaseLaw unscaled = model.law;
  unscaled.b_scale = unscaled.q_scale = 1.0;
  return Identified{fit.b_per_s / unscaled.decay_rate_per_s(facts.lowest_frequency_Hz),
                    fit.c_V / fit.a_V / unscaled.depth_ratio(facts.amplitude_N)};
}

}  // namespace

Result<CalibrationMap> calibration_map(const Model& model, const Plan& plan, double given_C) {
  const double temperature_C = std::isfinite(model.frame.temperature_C) ? model.frame.temperature_C : given_C;
  CalibrationMap map;
  const PlanCalibration& c = plan.calibration;
  if (c.level == CalibrationLevel::nominal) return map;
  CampaignInput input;
  map.known = true;
  FORCEGATE_CHECK_OK(sweeps(model, input, c, temperature_C, map));
  map.protocol = fmt::format("{} sweeps of {:g} s from {:g} to {:g} N", c.sweeps, c.sweep_s, c.sweep_low_N,
                             c.sweep_high_N);
  if (c.level != CalibrationLevel::identified || !model.law.decays) return map;

  FORCEGATE_TRY(const std::unique_ptr<Stimulus> stimulus, make_stimulus(c.identification->stimulus));
  const StimulusFacts facts = stimulus->facts();
  if (!facts.dynamic || !(facts.lowest_frequency_Hz > 0.0))
    return fail(ErrorCode::config, "the identification record of the plan is not cyclic", plan.path.string());
  RecordInput r = synthetic([&](double t) { return stimulus->force_N(t); }, stimulus->duration_s());
  r.dynamic = true;
  r.onset_s = facts.excitation_start_s;
  r.f_Hz = facts.lowest_frequency_Hz;
  r.A_N = facts.amplitude_N;
  r.F_min_N = facts.mean_N - facts.amplitude_N;
  set_decay(r, model.law);
  set_temperature(input, r, temperature_C);
  const CampaignInFrame in_frame(model.frame, std::move(input));
  Eigen::MatrixXd X(9, 3), Y(9, 2);
  Eigen::Index row = 0;
  for (double b : kAround)
    for (double q : kAround) {
      BaseLaw law = model.law;
      law.b_scale *= b;
      law.q_scale *= q;
      FORCEGATE_TRY(const Identified seen, identify(model, in_frame, r, facts, law));
      X.row(row) << 1.0, seen.b_scale, seen.q_scale;
      Y.row(row++) << law.b_scale, law.q_scale;
    }
  const Eigen::MatrixXd beta = X.colPivHouseholderQr().solve(Y);
  for (int k = 0; k < 3; ++k) {
    map.b[k] = beta(k, 0);
    map.q[k] = beta(k, 1);
  }
  map.residual_pct = 100.0 * ((X * beta - Y).array() / Y.array()).abs().maxCoeff();
  map.protocol += ", then " + stimulus_in_words(c.identification->stimulus);
  return map;
}

}  // namespace forcegate
