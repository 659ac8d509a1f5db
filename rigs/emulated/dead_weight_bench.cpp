#include "rigs/emulated/dead_weight_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/portable_math.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"
#include "rigs/emulated/white_noise.h"

namespace forcegate::emulated {
namespace {

constexpr std::size_t kSensors = 8;
constexpr double kForceMax_N = 250.0, kForceURel = 1e-4;  // weights of class M1
constexpr double kFeedbackURel = 1e-3, kBandwidthURel = 0.10;
constexpr double kPace = 0.2;  // relative spread of the time that a person takes for a weight
constexpr int kBits = 12;
constexpr double kRange_V = 10.0;
constexpr double kWhite_V = 3e-3, kFlicker_V = 5e-3, kFlicker_Hz = 500.0;

}  // namespace

WeightBenchInfo DeadWeightBench::info() const {
  WeightBenchInfo i;
  i.name = "dead_weight";
  i.version = "rc/1";
  i.sensors = kSensors;
  i.force_max_N = kForceMax_N;
  i.force_u_rel = kForceURel;
  i.feedback_ohm = options_.feedback_ohm;
  i.feedback_u_rel = kFeedbackURel;
  i.gain_bandwidth_Hz = options_.gain_bandwidth_Hz;
  i.gain_bandwidth_u_rel = kBandwidthURel;
  i.rail_V = options_.rail_V;
  i.rate_Hz = options_.rate_Hz;
  i.adc_bits = kBits;
  i.range_V = kRange_V;
  i.emulated = true;
  return i;
}

Result<void> DeadWeightBench::begin(const WeightBenchRequest& request) {
  sensors_.resize(kSensors);
  feedback_ohm_.assign(kSensors, options_.feedback_ohm);
  const std::string pack = std::to_string(request.set),
                    loading = pack + "/" + std::to_string(request.loading);
  Rng bench(request.seed, "dead_weight_bench/" + pack);
  const auto z = [&] { return options_.spread ? std::clamp(bench.normal(), -2.0, 2.0) : 0.0; };
  gain_bandwidth_Hz_ = options_.gain_bandwidth_Hz * (1.0 + kBandwidthURel * z());
  force_scale_ = 1.0 + kForceURel * z();
  for (std::size_t i = 0; i < kSensors; ++i) {
    feedback_ohm_[i] *= 1.0 + kFeedbackURel * z();
    RcSpecimen specimen;
    if (options_.spread)
      specimen = draw_rc_specimen(request.seed, request.set, i);
    else
      specimen.repeat_g_N = specimen.repeat_c_N = 0.0;
    sensors_[i].begin(specimen, Rng(request.seed, "rc_loading/" + loading + "/" + std::to_string(i)),
                      request.rest_before_s);
  }
  pace_ = Rng(request.seed, "dead_weight_pace/" + loading);
  noise_ = Rng(request.seed, "dead_weight_noise/" + loading);
  return {};
}

Result<void> DeadWeightBench::load(double force_N, double hold_s) {
  if (sensors_.empty()) return fail(ErrorCode::usage, "no loading has begun on the bench of weights");
  if (!(force_N >= 0.0 && force_N <= kForceMax_N) || !(hold_s >= 0.0))
    return fail(ErrorCode::usage, fmt::format("the bench holds 0 to {} N, not {} N", kForceMax_N, force_N));
  if (options_.spread) hold_s *= 1.0 + kPace * std::clamp(pace_.normal(), -2.0, 2.0);
  for (RcSensor& sensor : sensors_) sensor.load(force_N * force_scale_, hold_s);
  return {};
}

std::optional<std::complex<double>> DeadWeightBench::true_admittance_S(std::size_t sensor,
                                                                       double f_Hz) const {
  if (sensor >= sensors_.size()) return std::nullopt;
  return sensors_[sensor].admittance_S(f_Hz);
}

Result<void> DeadWeightBench::capture(std::size_t index, const WeightBenchSource& source,
                                      std::span<std::int16_t> codes) {
  if (index >= sensors_.size())
    return fail(ErrorCode::usage, fmt::format("the bench has no sensor {}", index));
  const bool sine = source.kind == WeightBenchSource::Kind::sine;
  if (sine && !(source.f_Hz > 0.0 && source.f_Hz < 0.5 * options_.rate_Hz))
    return fail(ErrorCode::usage,
                fmt::format("a sine of {} Hz cannot be sampled at {} Hz", source.f_Hz, options_.rate_Hz));
  const RcSensor& sensor = sensors_[index];
  const double f_Hz = sine ? source.f_Hz : 0.0;
  const std::complex<double> loop =
      feedback_ohm_[index] *
      (sine ? sensor.admittance_S(f_Hz) : std::complex<double>{sensor.state().conductance_S, 0.0});
  const std::complex<double> transfer =
      -loop / (1.0 + (1.0 + loop) * std::complex<double>{0.0, f_Hz / gain_bandwidth_Hz_});
  const double step_rad = 2.0 * std::numbers::pi * f_Hz / options_.rate_Hz;
  const std::complex<double> turn{portable::cos(step_rad), portable::sin(step_rad)};
  std::complex<double> phasor{sine ? 0.0 : 1.0, sine ? -1.0 : 0.0};  // its real part is sin, or 1
  phasor *= source.amplitude_V * transfer;
  WhiteNoise white(noise_.next(), "read"), flicker(noise_.next(), "flicker");
  const double keep = portable::exp(-2.0 * std::numbers::pi * kFlicker_Hz / options_.rate_Hz),
               fresh = kFlicker_V * std::sqrt(1.0 - keep * keep);
  double slow_V = kFlicker_V * flicker.next();
  const double per_volt = static_cast<double>(1 << kBits) / (2.0 * kRange_V);
  constexpr double kLast = (1 << (kBits - 1)) - 1;
  for (std::int16_t& code : codes) {
    double out_V = std::clamp(phasor.real(), -options_.rail_V, options_.rail_V);
    if (options_.noise) {
      slow_V = keep * slow_V + fresh * flicker.next();
      out_V += slow_V + kWhite_V * white.next();
    }
    code = static_cast<std::int16_t>(std::lround(std::clamp(out_V * per_volt, -kLast - 1.0, kLast)));
    phasor *= turn;
  }
  return {};
}

namespace {

Result<std::unique_ptr<WeightBench>> make(const std::map<std::string, std::string>& texts) {
  DeadWeightOptions options;
  for (const auto& [name, text] : texts) {
    if (name == "rate_Hz") {
      options.rate_Hz = read_number(text).value_or(0.0);
      if (options.rate_Hz < 1000.0 || options.rate_Hz > 2e6)
        return fail(ErrorCode::config, "option rate_Hz is a number from 1000 to 2000000");
      continue;
    }
    bool* flag = name == "noise" ? &options.noise : name == "spread" ? &options.spread : nullptr;
    if (flag == nullptr)
      return fail(ErrorCode::config, "the bench of weights has no option '" + printable_utf8(name) + "'", "--rig-option",
                  "it has: noise, rate_Hz, spread");
    if (text != "on" && text != "off") return fail(ErrorCode::config, "option " + name + " is on or off");
    *flag = text == "on";
  }
  return std::unique_ptr<WeightBench>(std::make_unique<DeadWeightBench>(options));
}

const Registration<WeightBenchKind> kRegistered{
    {"dead_weight",
     "Eight A201-100 under calibrated weights, 0 to 250 N (Paredes-Madrid 2010), in virtual time. Options: noise=on|off, rate_Hz, spread=on|off",
     make}};

}  // namespace
}  // namespace forcegate::emulated
