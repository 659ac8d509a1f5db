#include "hil/rig/self_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "hil/rig/witness/spring_watch.h"

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

class SelfCheck {
 public:
  SelfCheck(const RigInfo& info, const RigObservation& seen, const SelfCheckLimits& limits)
      : info_(info), o_(seen), limits_(limits), n_(static_cast<double>(seen.samples)) {}

  std::vector<Check> run() {
    if (o_.samples == 0) {
      add({"rig_samples", "Samples that never arrived", kNan, "1", limits_.lost_share, Blame::rig,
           "the rig gave no sample at all"});
      return std::move(checks_);
    }
    samples_and_clock();
    identity();
    zero();
    reference();
    drive();
    if (info_.geometry.eccentricity_mm > 0.0 && o_.spring_samples >= witness::SpringWatch::kLeastSamples) spring();
    sensor();
    return std::move(checks_);
  }

 private:
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  static constexpr double kInf = std::numeric_limits<double>::infinity();

  void add(Item item) { checks_.push_back(to_check(item)); }
  double share(std::uint64_t count) const { return static_cast<double>(count) / n_; }

  void samples_and_clock() {
    add({"rig_samples", "Share of samples that never arrived",
         o_.worst_gap_s > limits_.gap_s ? kInf : share(o_.lost + o_.time_gaps), "1", limits_.lost_share,
         Blame::link,
         o_.time_gaps == 0 ? fmt::format("{} of {} samples lost", o_.lost, o_.samples)
                           : fmt::format("{} samples lost, {} gaps in time, the longest {:.3f} s, of {}", o_.lost, o_.time_gaps,
                                         std::max(0.0, o_.worst_gap_s), o_.samples)});
    if (o_.samples < 1000) return;
    const double stamped_s = o_.last_t_s - o_.first_t_s, counted_s = (n_ - 1.0) / info_.rate_Hz;
    add({"rig_clock", "Time stamps against the number of samples, relative",
         std::fabs(stamped_s / counted_s - 1.0), "1", limits_.clock_rel, Blame::link,
         fmt::format("{:.3f} s by the time stamps, {:.3f} s by counting samples at {:g} Hz", stamped_s,
                     counted_s, info_.rate_Hz)});
  }

  void identity() {
    const auto read = info_.details.find("reference_calibration");
    const auto expected = info_.details.find("reference_calibration_expected");
    if (read == info_.details.end() || expected == info_.details.end()) return;
    same_calibration_ = read->second == expected->second;
    add({"rig_reference_identity", "The ATI runs with the calibration that the bench names",
         same_calibration_ ? 0.0 : 1.0, "1", 0.0, Blame::reference,
         fmt::format("calibration {} is loaded, the bench names {}", read->second, expected->second)});
  }

  void zero() {
    const double before = o_.zero_start_N, after = o_.zero_end_N;
    zero_known_ = std::isfinite(before);
    if (!zero_known_) return;
    const double worst =
        std::isfinite(after) ? std::max(std::fabs(before), std::fabs(after)) : std::fabs(before);
    zero_sound_ = worst <= limits_.zero_N;
    add({"rig_reference_zero", "Unloaded ATI reading", worst, "N", limits_.zero_N, Blame::reference,
         fmt::format("without load the ATI reads {:+.3f} N before the record, {:+.3f} N after it", before,
                     after)});
  }

  void reference() {
    const std::uint64_t bad = o_.reference_saturated + o_.reference_fault + o_.reference_not_finite;
    const auto slowest = info_.details.find(kSlowestCall);
    const bool other_call = slowest != info_.details.end() && slowest->second.find(kCallOfReference) == std::string::npos;
    const double late = std::max(number_of(kLateTickShare), other_call ? number_of(kLateTimeShare) : 0.0);
    const bool nobody_asked = o_.reference_saturated == 0 && share(bad) <= late;
    add({"rig_reference_valid", "Share of samples without a valid ATI reading", share(bad), "1",
         limits_.reference_bad_share, nobody_asked ? Blame::rig : Blame::reference,
         fmt::format("ATI: {} samples saturated, {} with an error, {} without a value, of {}",
                     o_.reference_saturated, o_.reference_fault, o_.reference_not_finite, o_.samples) +
             (!nobody_asked || bad == 0 ? ""
              : other_call
                  ? fmt::format("; for {:.2g} % of the time the harness was later than a reading counts, so that nobody fetched them: {}",
                                100.0 * late, slowest->second)
                  : fmt::format("; {:.2g} % of the harness's own ticks came later than a reading counts: the machine was busy, or the "
                                "adapter of an instrument holds the loop up", 100.0 * late))});
    const double quantisation_N = info_.reference_resolution_N / std::sqrt(12.0);
    const double declared_N = std::hypot(info_.reference_noise_N, quantisation_N);
    if (info_.reference_noise_N > 0.0)
      add({"rig_reference_noise", "Noise of the ATI reading", o_.reference_noise_N, "N",
           limits_.noise_factor * declared_N, Blame::reference,
           fmt::format("ATI noise {:.4f} N from second differences, {:.4f} N declared", o_.reference_noise_N,
                       declared_N)});
    const bool wheel = info_.geometry.eccentricity_mm > 0.0 && o_.spring_samples > 0;
    if (wheel || !info_.can_move)
      add({"rig_reference_alive", wheel ? "Longest time the ATI reading stood still while the wheel moved" : "Longest time the ATI reading stood still while the sensor's code moved",
           wheel && o_.reference_stale_s > limits_.stale_share * n_ / info_.rate_Hz ? kInf : o_.reference_frozen_s,
           "s", limits_.frozen_s, Blame::reference,
           fmt::format("the ATI reading did not change for {:.2f} s of motion, {:.2f} s in all",
                       o_.reference_frozen_s, o_.reference_stale_s) +
               (o_.reference_stale_s > 0.0 && std::fabs(o_.reference_min_N) <= 3.0 * declared_N ? "; it came down to 0 N: where the contact opens, a sound ATI stands still there" : "")});
  }

  /// Of the details; 0 where the rig tells none.
  double number_of(const char* detail) const {
    const auto at = info_.details.find(detail);
    double out = 0.0;
    if (at != info_.details.end()) std::from_chars(at->second.data(), at->second.data() + at->second.size(), out);
    return out;
  }

  void drive() {
    if (!info_.can_move) return;
    add({"rig_motor", "Longest time the commanded wheel stood still",
         o_.motor_fault > 0 ? kInf : o_.theta_still_while_commanded_s, "s", limits_.wheel_still_s, Blame::rig,
         o_.motor_fault > 0 ? fmt::format("the drive reported a fault on {} samples", o_.motor_fault)
                            : fmt::format("the wheel stood still for {:.2f} s while it was told to move",
                                          o_.theta_still_while_commanded_s)});
    if (std::isfinite(o_.following_rad))
      add({"rig_following", "Wheel angle beside the commanded one, beyond the drive's own lag, rms",
           o_.following_rad, "rad", limits_.following_rad + o_.command_step_rad, Blame::rig,
           fmt::format("the wheel leaves the commanded motion by {:.4f} rad rms; {:.4f} rad are allowed for the steps of the "
                       "command",
                       o_.following_rad, o_.command_step_rad)});
  }

  void spring() {
    // No spring is that soft or stiff: the ATI looks along another axis or through another calibration.
    const bool absurd = std::fabs(o_.spring_slope - 1.0) > 0.5;
    const bool steady =
        std::fabs(o_.spring_worst_bias_N - o_.spring_bias_N) <= 0.25 * std::fabs(o_.spring_bias_N) &&
        std::fabs(o_.spring_slope - 1.0) <= limits_.spring_slope;
    // A late ATI lags behind sensor and wheel alike; behind a wheel with play ATI and sensor keep together, but for the sensor's own lag.
    const bool lags = std::fabs(o_.reference_lag_s) > limits_.reference_lag_s;
    const bool together = std::fabs(o_.sensor_lag_s) < 0.5 * std::fabs(o_.reference_lag_s) || (o_.reference_lag_s > 0.0 && o_.sensor_lag_s > 0.0);
    const bool late = lags && !together;
    const bool reference = late || absurd || !same_calibration_ || (zero_known_ ? !zero_sound_ : steady);
    const bool slope_off = std::fabs(o_.spring_slope - 1.0) > limits_.spring_slope;
    const bool off = std::fabs(o_.spring_worst_bias_N) > limits_.spring_bias_N;  // nobody is blamed for what passes
    const char* why = !off                 ? ""
                      : late                 ? ": its reading is late"
                      : absurd             ? ": no spring is like that"
                      : !same_calibration_ ? ": another calibration is loaded"
                      : zero_known_
                          ? (!zero_sound_ ? ": unloaded the ATI is off as well"
                             : slope_off  ? ": unloaded the ATI is sound, so spring or preload are not as set, or the gain of "
                                            "the ATI is not, a known mass tells"
                                          : ": unloaded the ATI is sound, so spring or preload are not as set")
                      : steady ? ", the same from start to end: zero of the ATI (or a preload set wrongly)"
                               : "";
    if (std::isfinite(o_.reference_lag_s))
      add({"rig_reference_lag", "Lag of the ATI behind the spring force", std::fabs(o_.reference_lag_s), "s",
           limits_.reference_lag_s, late ? Blame::reference : Blame::rig,
           fmt::format("the ATI reading is {:+.1f} ms behind the wheel{}", 1000.0 * o_.reference_lag_s,
                       lags && !late ? ", and so is the sensor: play between shaft and wheel, or a reading that is late by less than the sensor's own lag" : "")});
    add({"rig_spring_witness", "ATI against spring and wheel angle, worst mean over 10 s",
         std::fabs(o_.spring_worst_bias_N), "N", limits_.spring_bias_N,
         reference ? Blame::reference : Blame::rig,
         fmt::format("ATI minus k x(theta): {:+.3f} N in the worst 10 s, {:+.3f} N over the record{}",
                     o_.spring_worst_bias_N, o_.spring_bias_N, why)});
    add({"rig_spring_slope", "Slope of ATI over spring force, distance from 1",
         std::fabs(o_.spring_slope - 1.0), "1", limits_.spring_slope,
         late || absurd || !same_calibration_ ? Blame::reference : Blame::rig,
         fmt::format("the ATI moves {:.3f} N for each newton of the spring{}", o_.spring_slope,
                     absurd || !same_calibration_ || !slope_off
                         ? ""
                         : ": stiffness of the spring or gain of the ATI, a known mass tells")});
    add({"rig_spring_scatter", "Scatter of ATI about the spring force", o_.spring_rms_N, "N",
         limits_.spring_scatter_N, reference ? Blame::reference : Blame::rig,
         fmt::format(
             "ATI minus k x(theta) scatters by {:.3f} N{}", o_.spring_rms_N,
             o_.spring_rms_N > limits_.spring_scatter_N ? ": play between shaft and wheel, or a late reading" : "")});
  }

  void sensor() {
    add({"rig_adc", "Converter bits that never changed",
         static_cast<double>(std::popcount(o_.adc_bits_stuck)), "1", 0.0, Blame::rig,
         fmt::format("codes {} to {}, stuck bits 0x{:04x}", o_.adc_min, o_.adc_max, o_.adc_bits_stuck)});
    const bool clipped = o_.sensor_clipped_s > 0.5 * o_.sensor_stale_s;
    // A recording may have been written faster than it was measured: short stretches of one code are no fault there.
    const bool stale = (info_.can_move || clipped) && o_.sensor_stale_s > limits_.stale_share * n_ / info_.rate_Hz;
    const bool many =
        o_.sensor_stale_s > 3.0 * o_.sensor_dead_s;  // one stretch is the sensor's, many are the link's
    add({"rig_sensor", "Longest time the sensor channel was dead", stale ? kInf : o_.sensor_dead_s, "s",
         limits_.sensor_dead_s, stale && many && !clipped ? Blame::link : Blame::sensor,
         fmt::format("one code for {:.2f} s of motion, or code 0 under load; {:.2f} s of stale codes in all{}",
                     o_.sensor_dead_s, o_.sensor_stale_s,
                     clipped ? fmt::format(", {:.2f} s of them at the largest code {}: the signal is cut off before the converter", o_.sensor_clipped_s, o_.adc_max)
                             : "")});
    add({"rig_sensor_jumps", "Share of samples at which the sensor's code jumps while the ATI stands",
         share(o_.sensor_jumps), "1", limits_.jump_share, Blame::sensor,
         fmt::format("{} jumps of more than 2 % of the range: a bad contact or a converter bit",
                     o_.sensor_jumps)});
    if (o_.sensor_blocks > 0)
      add({"rig_sensor_follows", "Share of 10-s blocks in which the sensor's code does not follow the ATI",
           static_cast<double>(o_.sensor_blocks_odd) / static_cast<double>(o_.sensor_blocks), "1",
           limits_.sensor_odd_share, Blame::sensor,
           fmt::format("{} of {} blocks in which the force moved", o_.sensor_blocks_odd, o_.sensor_blocks)});
  }

  const RigInfo& info_;
  const RigObservation& o_;
  const SelfCheckLimits& limits_;
  const double n_;
  bool same_calibration_ = true, zero_known_ = false, zero_sound_ = true;
  std::vector<Check> checks_;
};

}  // namespace

std::vector<Check> self_check(const RigInfo& info, const RigObservation& seen,
                              const SelfCheckLimits& limits) {
  return SelfCheck(info, seen, limits).run();
}

const Check* first_unsound(const std::vector<Check>& checks) {
  const auto at =
      std::find_if(checks.begin(), checks.end(), [](const Check& c) { return c.verdict != Verdict::pass; });
  return at == checks.end() ? nullptr : &*at;
}

}  // namespace forcegate
