#include "hil/rig/self_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace forcegate {
namespace {

struct Item {
  std::string id, title;
  double value;
  std::string unit;
  double limit;
  Blame blame;
  std::string evidence;
};

Check to_check(const Item& item) {
  Check c;
  c.id = item.id;
  c.title = item.title;
  c.value = item.value;
  c.unit = item.unit;
  c.limit = {Limit::Kind::upper, item.limit, "ours: rig self-check"};
  c.verdict = item.value <= item.limit ? Verdict::pass : Verdict::rig_error;  // NaN is never a pass
  c.blame = c.verdict == Verdict::pass ? Blame::none : item.blame;
  c.evidence = item.evidence;
  return c;
}

}  // namespace

std::vector<Check> self_check(const RigInfo& info, const RigObservation& o, const SelfCheckLimits& limits) {
  std::vector<Check> checks;
  const auto add = [&](Item item) { checks.push_back(to_check(item)); };
  if (o.samples == 0) {
    add({"rig_samples", "Samples that never arrived", std::numeric_limits<double>::quiet_NaN(), "1",
         limits.lost_share, Blame::rig, "the rig gave no sample at all"});
    return checks;
  }
  const double n = static_cast<double>(o.samples);
  const auto share = [n](std::uint64_t count) { return static_cast<double>(count) / n; };

  const std::uint64_t bad = o.reference_saturated + o.reference_fault + o.reference_not_finite;
  add({"rig_reference_valid", "Share of samples without a valid ATI reading", share(bad), "1",
       limits.reference_bad_share, Blame::reference,
       fmt::format("ATI: {} samples saturated, {} with an error, {} without a value, of {}",
                   o.reference_saturated, o.reference_fault, o.reference_not_finite, o.samples)});

  const double quantisation_N = info.reference_resolution_N / std::sqrt(12.0);
  const double declared_N = std::hypot(info.reference_noise_N, quantisation_N);
  if (info.reference_noise_N > 0.0)
    add({"rig_reference_noise", "Noise of the ATI reading", o.reference_noise_N, "N",
         limits.noise_factor * declared_N, Blame::reference,
         fmt::format("ATI noise {:.4f} N from second differences, {:.4f} N declared", o.reference_noise_N,
                     declared_N)});

  const bool wheel = info.geometry.eccentricity_mm > 0.0 && o.spring_samples > 0;
  if (wheel) {
    add({"rig_reference_alive", "Longest time the ATI reading stood still while the wheel moved",
         o.reference_frozen_s, "s", limits.frozen_s, Blame::reference,
         fmt::format("the ATI reading did not change for {:.2f} s of motion", o.reference_frozen_s)});
    // A spring that slips changes the difference while the record runs; a zero error of the reference is there
    // from the first sample to the last and leaves the slope alone.
    const bool steady = std::fabs(o.spring_worst_bias_N - o.spring_bias_N) <= 0.25 * std::fabs(o.spring_bias_N) &&
                        std::fabs(o.spring_slope - 1.0) <= limits.spring_slope;
    add({"rig_spring_witness", "ATI against spring and wheel angle, worst mean over 10 s",
         std::fabs(o.spring_worst_bias_N), "N", limits.spring_bias_N, steady ? Blame::reference : Blame::rig,
         fmt::format("ATI minus k x(theta): {:+.3f} N in the worst 10 s, {:+.3f} N over the record{}",
                     o.spring_worst_bias_N, o.spring_bias_N,
                     steady ? ", the same from start to end: zero of the ATI (or a preload set wrongly)" : "")});
    add({"rig_spring_slope", "Slope of ATI over spring force, distance from 1",
         std::fabs(o.spring_slope - 1.0), "1", limits.spring_slope, Blame::rig,
         fmt::format("the ATI moves {:.3f} N for each newton of the spring", o.spring_slope)});
  }
  if (info.can_move)
    add({"rig_motor", "Longest time the commanded wheel stood still",
         o.motor_fault > 0 ? std::numeric_limits<double>::infinity() : o.theta_still_while_commanded_s, "s",
         limits.wheel_still_s, Blame::rig,
         o.motor_fault > 0 ? fmt::format("the drive reported a fault on {} samples", o.motor_fault)
                           : fmt::format("the wheel stood still for {:.2f} s while it was told to move",
                                         o.theta_still_while_commanded_s)});
  add({"rig_sensor", "Longest time the sensor channel was dead", o.sensor_dead_s, "s", limits.sensor_dead_s,
       Blame::sensor, fmt::format("one code for {:.2f} s of motion, or code 0 under load", o.sensor_dead_s)});
  add({"rig_samples", "Share of samples that never arrived", share(o.lost + o.time_gaps), "1",
       limits.lost_share, Blame::link,
       fmt::format("{} samples lost, {} gaps in time, of {}", o.lost, o.time_gaps, o.samples)});
  add({"rig_adc", "Converter bits that never changed", static_cast<double>(std::popcount(o.adc_bits_stuck)),
       "1", 0.0, Blame::rig,
       fmt::format("codes {} to {}, stuck bits 0x{:04x}", o.adc_min, o.adc_max, o.adc_bits_stuck)});
  return checks;
}

const Check* first_unsound(const std::vector<Check>& checks) {
  const auto at =
      std::find_if(checks.begin(), checks.end(), [](const Check& c) { return c.verdict != Verdict::pass; });
  return at == checks.end() ? nullptr : &*at;
}

}  // namespace forcegate
