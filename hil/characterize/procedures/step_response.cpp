// Step response (III-B, Fig. 5): a step of the wheel from 1 to 4 N. Time from the first command to the motor's velocity
// controller, which leaves one control period before the set-point steps (open_loop.cpp), until a signal stays within 5 %
// of the step around its final value; centred moving mean over 5 ms, for noise is no settling. NaN where it does not settle
// or never leaves that band. Lag of the sensor behind the ATI: area between the two normalised responses, which for one
// pole is its time constant.

#include <cmath>
#include <limits>
#include <vector>

#include "hil/characterize/session.h"
#include "hil/rig/control_period.h"

namespace forcegate::characterize {
namespace {

constexpr double kLow_N = 1.0, kHigh_N = 4.0, kAt_s = 2.0, kDuration_s = 5.0, kInside = 0.05, kSearch_s = 0.9;

double mean(const std::vector<float>& v, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += static_cast<double>(v[i]);
  return sum / static_cast<double>(to - from);
}

struct Response {
  const std::vector<float>& v;
  double rate_Hz, begin_s, start, end;

  Response(const std::vector<float>& of, double at_rate_Hz, double from_s)
      : v(of), rate_Hz(at_rate_Hz), begin_s(from_s), start(mean(v, row(begin_s - 0.5), row(begin_s))),
        end(mean(v, row(kAt_s + kSearch_s), row(kAt_s + 1.4))) {}
  std::size_t row(double t_s) const { return static_cast<std::size_t>(t_s * rate_Hz + 0.5); }
};

// The first whole period that ends with the step or behind it.
double command_s(double rate_Hz) {
  const ControlPeriod period = control_period(rate_Hz);
  const double step_row = std::ceil(kAt_s * rate_Hz - 1e-6), samples = static_cast<double>(period.samples);
  return (std::ceil(step_row / samples) - 1.0) * period.s;
}

double settling_s(const Response& r) {
  const auto width = std::max<std::size_t>(1, r.row(0.005));
  const std::size_t begin = r.row(r.begin_s), end = r.row(kAt_s + kSearch_s);
  std::size_t inside = begin;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t from = i - width / 2;
    if (!(std::abs(mean(r.v, from, from + width) - r.end) <= kInside * std::abs(r.end - r.start))) inside = i + 1;
  }
  if (inside == begin || inside == end) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(inside - begin) / r.rate_Hz;
}

double lag_s(const Response& ati, const Response& sensor) {
  const std::size_t from = ati.row(ati.begin_s), to = ati.row(kAt_s + kSearch_s);
  const auto part = [&](const Response& r) { return (mean(r.v, from, to) - r.start) / (r.end - r.start); };
  return (part(ati) - part(sensor)) * static_cast<double>(to - from) / ati.rate_Hz;
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
  const double begin_s = command_s(played.rig.rate_Hz);
  const Response by_ati(ati, played.rig.rate_Hz, begin_s), by_sensor(sensor, played.rig.rate_Hz, begin_s);
  s.add("step.ati", "Step response of the Nano17", "ms", 1e3 * settling_s(by_ati));
  s.add("step.sensor", "Step response of the sensor", "ms", 1e3 * settling_s(by_sensor));
  s.add("step.lag", "Lag of the sensor behind the Nano17", "ms", 1e3 * lag_s(by_ati, by_sensor));
  if (s.curves) {
    s.sheet.curves.push_back(curve.finish());
    s.sheet.curves.back().zero_s = begin_s;
  }
  return {};
}

const Registration<ProcedureKind> kRow{
    {"step_response", "A step from 1 to 4 N: time to the final value of ATI and sensor (III-B, Fig. 5)", true, run,
     always({"step.ati", "step.sensor", "step.lag"})}};

}  // namespace
}  // namespace forcegate::characterize
