#include "rigs/emulated/hidden/plant.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/portable_math.h"
#include "rigs/emulated/hidden/numeric.h"
#include "rigs/emulated/hidden/profile.h"

namespace forcegate::hidden {
namespace {

constexpr double kTwoPi = 2.0 * kPi;

RecordTruth draw_truth(const Conditions& c, const RecordPlan& plan) {
  Rng rng(plan.seed, "repeatability"), session(plan.session_seed, "repeatability");
  RecordTruth truth;
  const double own = std::sqrt(1.0 - c.session_share), shared = std::sqrt(c.session_share);
  const auto scatter = [&] { return own * rng.normal() + shared * session.normal(); };
  truth.gain_N_per_V = c.gain_N_per_V * std::max(0.5, 1.0 + c.sd_gain * scatter());
  truth.offset_N = c.offset_N + 0.01 * c.sd_offset_pct * 5.0 * scatter();
  truth.b_scale = c.b_scale * std::max(0.2, 1.0 + c.sd_b * rng.normal());
  truth.q_scale = c.q_scale * std::max(0.3, 1.0 + c.sd_q * rng.normal());
  truth.spring_N_per_mm = c.spring_N_per_mm;
  truth.wheel_radius_mm = c.wheel_radius_mm;
  const double k = c.spring_N_per_mm, span_N = plan.high_N - plan.low_N;
  if (plan.wheel) {
    truth.eccentricity_mm = 0.5 * span_N / k;
    truth.preload_mm = plan.low_N / k;
  } else {
    truth.preload_mm = std::max(0.0, (plan.low_N - 0.03 * span_N) / k);
    truth.eccentricity_mm = std::min(12.0, 0.53 * (plan.high_N - k * truth.preload_mm) / k + 0.05);
  }
  return truth;
}

/// Velocity-controlled motor with one time constant; the wheel turns through or servoes to the set-point.
void turn_wheel(const Conditions& c, const RecordPlan& plan, const RecordTruth& truth, Waves& waves) {
  const double h = waves.step_s, follow = 1.0 - portable::exp(-h / c.motor_tau_s);
  const double k = truth.spring_N_per_mm, e = truth.eccentricity_mm, p = truth.preload_mm;
  constexpr double kLoop_per_s = 22.0, kSpeedLimit_rad_per_s = 45.0;
  double theta = 0.0, omega = 0.0, target_before = 0.0;
  const auto angle_of = [&](double force_N) { return arc_cosine(1.0 - (force_N / k - p) / e); };
  if (!plan.wheel) theta = target_before = angle_of(waves.setpoint_N.front());
  for (std::size_t i = 0; i < waves.size(); ++i) {
    waves.theta_rad[i] = theta;
    double command;
    if (plan.wheel) {
      const bool turning = static_cast<double>(i) * h >= plan.excitation_start_s;
      command = turning ? kTwoPi * plan.frequencies_Hz.front() : 0.0;
    } else {
      const double target = angle_of(waves.setpoint_N[i]);
      command = kLoop_per_s * (target - theta) + std::clamp((target - target_before) / h, -20.0, 20.0);
      command = std::clamp(command, -kSpeedLimit_rad_per_s, kSpeedLimit_rad_per_s);
      target_before = target;
    }
    omega += follow * (command - omega);
    theta += h * omega;
  }
}

void compress_spring(const RecordTruth& truth, Waves& waves) {
  for (std::size_t i = 0; i < waves.size(); ++i)
    waves.travel_mm[i] = truth.preload_mm + truth.eccentricity_mm * (1.0 - portable::cos(waves.theta_rad[i]));
}

void push(const RecordTruth& truth, Waves& waves) {
  for (std::size_t i = 0; i < waves.size(); ++i)
    waves.force_N[i] = std::max(0.0, truth.spring_N_per_mm * waves.travel_mm[i]);
}

void read_reference(const Conditions& c, Waves& waves) {
  if (c.reference_lag_s < 1e-5) {
    waves.reference_N = waves.force_N;
    return;
  }
  const double follow = 1.0 - portable::exp(-waves.step_s / c.reference_lag_s);
  double y = waves.force_N.front();
  for (std::size_t i = 0; i < waves.size(); ++i) waves.reference_N[i] = y += follow * (waves.force_N[i] - y);
}

/// The decay law is told the range that the loading really reached, as the film knows no command.
void measure_range(const Waves& waves, RecordPlan& plan) {
  if (!plan.dynamic) return;
  const auto first = static_cast<std::size_t>((plan.excitation_start_s + 2.0) / waves.step_s);
  if (first >= waves.size()) return;
  const auto [low, high] =
      std::minmax_element(waves.force_N.begin() + static_cast<std::ptrdiff_t>(first), waves.force_N.end());
  plan.low_N = *low;
  plan.high_N = *high;
}

Samples sample(const Conditions& c, const RecordContext& context, const Waves& waves, const Effects& effects,
               double rate_Hz) {
  Samples s;
  const RecordPlan& plan = context.plan;
  const auto n = static_cast<std::size_t>(plan.duration_s * rate_Hz);
  for (auto* column : {&s.instant_s, &s.stamp_s, &s.voltage_V, &s.reference_N, &s.theta_rad, &s.setpoint_N})
    column->resize(n);
  Rng jitter(plan.seed, "jitter"), noise(plan.seed, "noise"), cell(plan.seed, "reference");
  const double per_step = 1.0 / waves.step_s, period_s = 1.0 / rate_Hz;
  const double leave = c.wander_V * std::sqrt(2.0 * period_s / c.wander_tau_s);
  double wander_V = c.wander_V * noise.normal();
  for (std::size_t i = 0; i < n; ++i) {
    const double nominal = static_cast<double>(i) * period_s;
    double t = nominal * (1.0 + 1e-6 * c.clock_ppm);
    if (c.jitter_share > 0.0) t += c.jitter_share * period_s * std::clamp(jitter.normal(), -3.0, 3.0);
    t = std::max(t, 0.0);
    s.instant_s[i] = t;
    s.stamp_s[i] = c.stamps_true ? t : nominal;
    double at = t;
    for (const auto& effect : effects) at = effect->voltage_instant_s(at, context);
    wander_V += leave * noise.normal() - wander_V * period_s / c.wander_tau_s;
    s.voltage_V[i] =
        interpolate(waves.voltage_V, at * per_step) + wander_V + c.voltage_noise_V * noise.normal();
    s.reference_N[i] = interpolate(waves.reference_N, t * per_step) + c.reference_noise_N * cell.normal();
    s.theta_rad[i] = interpolate(waves.theta_rad, t * per_step);
    s.setpoint_N[i] = interpolate(waves.setpoint_N, t * per_step);
  }
  return s;
}

void convert(const Conditions& c, const RecordContext& context, const Effects& effects, Samples& s) {
  const int top = (1 << c.adc_bits) - 1;
  std::vector<int> codes(s.size());
  for (std::size_t i = 0; i < s.size(); ++i)
    codes[i] =
        static_cast<int>(std::clamp(std::round(s.voltage_V[i] / c.voltage_max_V * top), 0.0, 1.0 * top));
  for (const auto& effect : effects) effect->codes(codes, c.adc_bits, context);
  for (std::size_t i = 0; i < s.size(); ++i) s.voltage_V[i] = c.voltage_max_V * codes[i] / top;
  for (double& force : s.reference_N) force = std::round(force / c.reference_step_N) * c.reference_step_N;
}

void slow_columns(const Conditions& c, const RecordContext& context, const Waves& waves, RecordData& record) {
  const RecordPlan& plan = context.plan;
  Rng rng(plan.seed, "slow");
  const std::size_t n = record.stamp_s.size();
  // a slow instrument holds each reading for a while
  const auto held = [&](double every_s, const auto& read) {
    std::vector<double> out(n);
    double value = 0.0, next_s = -1.0;
    for (std::size_t i = 0; i < n; ++i) {
      if (record.stamp_s[i] >= next_s) {
        value = read(plan.start_s + record.stamp_s[i]);
        next_s = record.stamp_s[i] + every_s;
      }
      out[i] = value;
    }
    return out;
  };
  if (c.log_temperature)
    record.temperature_C = held(1.0, [&](double at_s) { return std::round((context.climate.temperature_C(at_s) + 0.02 * rng.normal()) / 0.05) * 0.05; });
  if (c.log_humidity) {
    Rng hygrometer(plan.seed, "hygrometer");
    record.humidity_pct = held(10.0, [&](double at_s) { return std::round((context.climate.humidity_pct(at_s) + 0.2 * hygrometer.normal()) * 10.0) / 10.0; });
  }
  if (c.log_capacitance) {
    record.capacitance_F.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double F = interpolate(waves.force_N, record.stamp_s[i] / waves.step_s);
      record.capacitance_F[i] = 1e-12 * (22.0 + 3.1 * F - 0.11 * F * F + 0.12 * rng.normal());
    }
  }
}

/// Rows that the logger lost: gone from every column, the stamps jump.
void lose_rows(const Conditions& c, RecordData& record) {
  if (!(c.gaps_per_hour > 0.0) || record.stamp_s.empty()) return;
  Rng rng(record.plan.seed, "gaps");
  std::vector<std::size_t> keep;
  const double mean_s = 3600.0 / c.gaps_per_hour;
  double next_s = -mean_s * portable::log(1.0 - rng.uniform());
  for (std::size_t i = 0; i < record.stamp_s.size(); ++i) {
    if (record.stamp_s[i] >= next_s) {
      const double until_s = next_s + rng.uniform(0.02, 0.6);
      next_s = until_s - mean_s * portable::log(1.0 - rng.uniform());
      while (i < record.stamp_s.size() && record.stamp_s[i] < until_s) ++i;
      if (i == record.stamp_s.size()) break;
    }
    keep.push_back(i);
  }
  for (auto* column :
       {&record.stamp_s, &record.force_ref_N, &record.voltage_V, &record.theta_rad, &record.setpoint_N,
        &record.temperature_C, &record.humidity_pct, &record.capacitance_F, &record.force_unrounded_N}) {
    if (column->empty()) continue;
    for (std::size_t k = 0; k < keep.size(); ++k) (*column)[k] = (*column)[keep[k]];
    column->resize(keep.size());
  }
}

}  // namespace

std::vector<RecordData> run_campaign(const Conditions& c, const Climate& climate,
                                     const std::vector<RecordPlan>& plans, const Effects& effects,
                                     const Clocking& clocking) {
  std::vector<RecordData> records;
  records.reserve(plans.size());
  for (const auto& effect : effects) effect->begin_campaign();
  Waves waves;
  for (std::size_t index = 0; index < plans.size(); ++index) {
    RecordPlan plan = plans[index];
    RecordTruth truth = draw_truth(c, plan);
    const RecordContext context{plan, truth, climate, index, 5.0, c.voltage_max_V};
    const double rate_Hz = std::min(plan.rate_Hz, clocking.sampling_Hz_max);
    waves.step_s = 1.0 / (rate_Hz * std::ceil(clocking.internal_Hz / rate_Hz));
    const auto n = static_cast<std::size_t>(plan.duration_s / waves.step_s) + 2;
    for (auto* wave : {&waves.setpoint_N, &waves.theta_rad, &waves.travel_mm, &waves.force_N, &waves.film_N,
                       &waves.voltage_V, &waves.reference_N})
      wave->resize(n);
    waves.airborne.clear();

    for (const auto& effect : effects) effect->begin_record(context);
    fill_setpoint(plan, waves);
    turn_wheel(c, plan, truth, waves);
    for (const auto& effect : effects) effect->angle(waves, context);
    compress_spring(truth, waves);
    for (const auto& effect : effects) effect->travel(waves, context);
    push(truth, waves);
    for (const auto& effect : effects) effect->force(waves, context);
    measure_range(waves, plan);
    truth.reached_low_N = plan.low_N;
    truth.reached_high_N = plan.high_N;
    read_reference(c, waves);
    for (const auto& effect : effects) effect->reference(waves, context);
    waves.film_N = waves.force_N;
    for (const auto& effect : effects) effect->film(waves, context);
    apply_decay(c.decay, waves, context);
    for (const auto& effect : effects) effect->voltage(waves, context);
    for (const auto& effect : effects) effect->electronics(waves, context);
    Samples samples = sample(c, context, waves, effects, rate_Hz);
    for (const auto& effect : effects) effect->samples(samples, context);

    RecordData record;
    record.force_unrounded_N = samples.reference_N;
    convert(c, context, effects, samples);
    for (const auto& effect : effects) effect->logged(samples, context);
    record.plan = plans[index];
    record.truth = truth;
    record.stamp_s = std::move(samples.stamp_s);
    record.voltage_V = std::move(samples.voltage_V);
    record.force_ref_N = std::move(samples.reference_N);
    if (clocking.slow_columns) {
      if (c.log_theta) record.theta_rad = std::move(samples.theta_rad);
      if (c.log_command) record.setpoint_N = std::move(samples.setpoint_N);
      slow_columns(c, context, waves, record);
    }
    lose_rows(c, record);
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace forcegate::hidden
