// Step response (III-B, Fig. 5): a step of the wheel from 1 to 4 N. Time from the set-point's step until a signal stays
// within 5 % of the step around its final value; moving mean over 5 ms, for noise is no settling. Lag of the sensor
// behind the ATI: area between the two normalised responses, which for one pole is its time constant.

#include <cmath>
#include <vector>

#include "hil/characterize/session.h"

namespace forcegate::characterize {
namespace {

constexpr double kLow_N = 1.0, kHigh_N = 4.0, kAt_s = 2.0, kDuration_s = 5.0, kInside = 0.05, kSearch_s = 0.9;

double mean(const std::vector<float>& v, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += static_cast<double>(v[i]);
  return sum / static_cast<double>(to - from);
}

double settling_s(const std::vector<float>& v, double rate_Hz) {
  const auto at = [&](double t_s) { return static_cast<std::size_t>(t_s * rate_Hz + 0.5); };
  const auto width = std::max<std::size_t>(1, at(0.005));
  const double start = mean(v, at(kAt_s - 0.5), at(kAt_s)),
               end = mean(v, at(kAt_s + kSearch_s), at(kAt_s + 1.4));
  std::size_t last = at(kAt_s);
  for (std::size_t i = last; i < at(kAt_s + kSearch_s); ++i)
    if (std::abs(mean(v, i, i + width) - end) > kInside * std::abs(end - start)) last = i;
  return static_cast<double>(last + 1 - at(kAt_s)) / rate_Hz;
}

double lag_s(const std::vector<float>& ati, const std::vector<float>& sensor, double rate_Hz) {
  const auto at = [&](double t_s) { return static_cast<std::size_t>(t_s * rate_Hz + 0.5); };
  const auto part = [&](const std::vector<float>& v, std::size_t i) {
    const double start = mean(v, at(kAt_s - 0.5), at(kAt_s)),
                 end = mean(v, at(kAt_s + kSearch_s), at(kAt_s + 1.4));
    return (mean(v, at(kAt_s), i) - start) / (end - start);
  };
  const std::size_t to = at(kAt_s + kSearch_s);
  return (part(ati, to) - part(sensor, to)) * kSearch_s;
}

Result<void> run(Session& s) {
  const StimulusSpec step{
      "step",
      {{"low_N", kLow_N}, {"high_N", kHigh_N}, {"at_s", kAt_s}, {"duration_s", kDuration_s}},
      {},
      {},
      1};
  std::vector<float> ati, sensor;
  CurveSink curve("fig5", kAt_s - 0.1, kAt_s + 0.4, s.bench.volts_per_code(), false, 500);
  const double per_code = s.bench.volts_per_code();
  FORCEGATE_TRY(const PlayedRecord played,
                s.bench.play(step, [&](const RigBlock& b, std::size_t n, std::span<const float> none) {
                  if (s.curves) curve(b, n, none);
                  for (std::size_t i = 0; i < n; ++i) {
                    ati.push_back(b.force_ref_N[i]);
                    sensor.push_back(static_cast<float>(per_code * b.adc[i]));
                  }
                }));
  s.add("step.ati", "Step response of the Nano17", "ms", 1e3 * settling_s(ati, played.rig.rate_Hz));
  s.add("step.sensor", "Step response of the sensor", "ms", 1e3 * settling_s(sensor, played.rig.rate_Hz));
  s.add("step.lag", "Lag of the sensor behind the Nano17", "ms",
        1e3 * lag_s(ati, sensor, played.rig.rate_Hz));
  if (s.curves) s.sheet.curves.push_back(curve.finish());
  return {};
}

const Registration<ProcedureKind> kRow{
    {"step_response", "A step from 1 to 4 N: time to the final value of ATI and sensor (III-B, Fig. 5)", true,
     run}};

}  // namespace
}  // namespace forcegate::characterize
