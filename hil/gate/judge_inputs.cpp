#include "hil/gate/judge_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "hil/gate/blame.h"
#include "hil/gate/input_checks.h"
#include "hil/rig/self_check.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kExtremaMissing = 0.02;

struct ReferenceExtrema {
  std::size_t followed = 0;
  std::size_t led_astray = 0;  ///< not followed, while the firmware reported another force than the reference
};

// The extrema are those of the set-point: the reference has one where its force went there from the one before, if by less.
ReferenceExtrema extrema_of_reference(const CaseRecord& record) {
  constexpr double kOfSwing = 0.3;
  ReferenceExtrema out;
  double setpoint_N = 0.0, ati_N = 0.0;  // unloaded, before the first
  for (const CasePair& p : record.pairs) {
    const double swing_N = p.setpoint_N - setpoint_N, followed_N = p.ati_N - ati_N;
    if (p.t_s >= record.facts.excitation_start_s && followed_N / swing_N >= kOfSwing) ++out.followed;
    else if (!(std::fabs(p.dut_N - p.ati_N) <= kDeparture_N)) ++out.led_astray;
    setpoint_N = p.setpoint_N, ati_N = p.ati_N;
  }
  return out;
}

class InputJudge {
 public:
  InputJudge(const Plan& plan, const PlanCase& planned, const CaseRecord& record, CaseChecks& checks, JudgedCase& out)
      : plan_(plan), planned_(planned), record_(record), checks_(checks), out_(out) {}

  InputsFound run() {
    rig();
    input();
    safety();
    coverage();
    link();
    out_.sound = checks_.rig_sound && checks_.complete;
    return found_;
  }

 private:
  void rig() {
    std::vector<Check> checks = self_check(record_.rig, record_.observed, plan_.self_check);
    const bool closed = planned_.loop == LoopMode::closed;
    const RigObservation& o = record_.observed;
    const auto input = input_checks(plan_, record_);
    const bool late_rows = std::any_of(input.begin(), input.end(), [](const Check& c) {
      return c.id == "rig_sensor_sync" && c.verdict == Verdict::rig_error && c.blame == Blame::link;
    });
    for (Check& c : checks) {
      if (c.verdict == Verdict::pass) continue;
      if (late_rows && c.id == "rig_following") {  // a command is then held against an angle of another time
        c.required = false;
        c.blame = Blame::link;
        c.evidence += "; the board's rows are late";
        continue;
      }
      const bool driven = closed && c.id == "rig_reference_valid" &&
                          o.reference_fault + o.reference_not_finite == 0 && o.reference_saturated > 0;
      if (driven) {
        const bool others_sound = std::all_of(checks.begin(), checks.end(), [&](const Check& other) {
          return other.id == c.id || other.verdict == Verdict::pass;
        });
        // Overload below the reference's own range is its fault, whoever drove the force.
        const bool real =
            o.reference_max_N >= 0.9 * std::min(record_.rig.force_max_N, plan_.safety.force_max_N);
        if (others_sound && real && firmware_left_the_reference(record_)) {
          charged_ = true;
          c.evidence += "; the build drove the force there, spring witness, motor and link are sound";
          c.verdict = Verdict::pass;
          c.required = false;
          continue;
        }
      }
      checks_.unsound(c.blame);
    }
    for (Check& c : checks) checks_.keep(std::move(c));
  }

  void input() {
    for (Check& c : input_checks(plan_, record_)) {
      if (c.verdict == Verdict::rig_error) checks_.unsound(c.blame);
      if (c.verdict == Verdict::inconclusive) found_.calibration_fits = false;
      checks_.keep(std::move(c));
    }
  }

  void safety() {
    const SafetyReport& s = record_.safety;
    if (!s.stopped()) return;
    out_.safety_stop = true;
    out_.safety_text =
        fmt::format("safety stop at {:.1f} s: {} ({:.2f} N)", s.t_s, to_string(s.reason), s.force_N);
    const bool closed = planned_.loop == LoopMode::closed;
    const bool rig_reason = s.reason == StopReason::motor_fault || s.reason == StopReason::rig_stopped ||
                            (s.reason == StopReason::reference_lost && !charged_);
    if (!checks_.rig_sound || rig_reason) {
      checks_.rig_sound = false;
      checks_.final_check("safety_stop", "No safety stop", Verdict::rig_error,
                          checks_.rig_blame == Blame::none ? Blame::rig : checks_.rig_blame,
                          out_.safety_text);
    } else if (closed && firmware_left_the_reference(record_)) {
      charged_ = true;
      checks_.final_check(
          "safety_stop", "No safety stop", Verdict::fail, Blame::firmware,
          no_number_before(s.t_s) ? fmt::format("the firmware answers no number (NaN or infinite) from {:.1f} s on; {}; motor, spring witness and link are sound",
                                                record_.output.first_not_finite_s, out_.safety_text)
                                  : out_.safety_text + "; motor, spring witness and link are sound and the firmware had left the ATI");
    } else {
      out_.safety_cause_decided = false;
      checks_.final_check("safety_stop", "No safety stop", Verdict::inconclusive, Blame::rig,
                          out_.safety_text + "; the cause is not decided");
    }
  }

  // What makes a command no number is told before the stop that it makes.
  bool no_number_before(double t_s) const { return record_.output.not_finite > 0 && record_.output.first_not_finite_s <= t_s; }

  void coverage() {
    const double expected = static_cast<double>(record_.expected_samples);
    const double missing = expected > 0.0 ? 1.0 - static_cast<double>(record_.samples) / expected : kNan;
    checks_.complete = missing == 0.0;
    if (record_.observed.time_not_monotone > 0) {
      checks_.unsound(Blame::link);
      checks_.final_check("time_base", "Time runs forward", Verdict::rig_error, Blame::link,
                          fmt::format("time does not advance {} times", record_.observed.time_not_monotone));
    }
    if (!checks_.complete) checks_.incomplete_blame = charged_ ? Blame::firmware : Blame::link;
    const std::uint64_t have = record_.samples, want = record_.expected_samples;
    Check& c = checks_.value_check(
        "coverage", "Share of the record that is missing", missing, "1", 0.0, want,
        {Limit::Kind::upper, 0.0, "ours: a record is whole"},
        checks_.complete ? fmt::format("{} samples, {:.0f} s", have, record_.duration_s)
                         : fmt::format("the record is truncated: {} of {} samples", have, want));
    if (!checks_.complete && charged_) c.required = false;  // the stop itself is the finding
    if (!checks_.complete && !charged_ && record_.rig.can_move && !record_.safety.stopped()) {
      checks_.list.back().judgeable = false;
      c.verdict = Verdict::rig_error;  // played again it may be whole
      c.blame = checks_.rig_sound ? Blame::link : checks_.rig_blame;
    }
    extrema_count();
    if (found_.calibration_fits || !checks_.complete) return;
    checks_.complete = false;
    checks_.incomplete_blame = Blame::calibration;
  }

  void extrema_count() {
    const auto expected = static_cast<double>(record_.expected_extrema);
    if (expected < 4.0 || !checks_.complete) return;
    const ReferenceExtrema extrema = extrema_of_reference(record_);
    const auto missing_of = [&](std::size_t found) { return std::max(0.0, (expected - static_cast<double>(found) - 2.0) / expected); };
    const double missing = missing_of(extrema.followed);
    const bool astray = missing > kExtremaMissing && missing_of(extrema.followed + extrema.led_astray) <= kExtremaMissing && answers_for_the_force();
    if (missing > kExtremaMissing) checks_.complete = false, checks_.incomplete_blame = astray ? Blame::firmware : Blame::rig;
    checks_.value_check("extrema_count", "Share of the profile's extrema that are missing", missing, "1", 0.0, record_.expected_extrema,
                        {Limit::Kind::upper, kExtremaMissing, "ours: the profile was played"},
                        fmt::format("the reference followed {} of {:.0f} extrema of the profile", extrema.followed, expected));
    if (!astray) return;
    checks_.judge_even_if_incomplete();
    checks_.list.back().check.title = "Share of the profile's extrema that the ATI missed, led astray by the firmware";
    checks_.list.back().check.evidence += fmt::format("; at {} of the others the firmware had left the ATI by more than {:g} N, and wheel, spring witness and link are sound",
                                                      extrema.led_astray, kDeparture_N);
  }

  // The rule of the safety stop: in a closed loop the force goes where the firmware's estimate takes it. What is known to be its algorithm's
  // answer to these codes may be the sensor's doing.
  bool answers_for_the_force() const {
    const bool conforms = record_.conformance_known && record_.conformance <= record_.conformance_limit;
    return planned_.loop == LoopMode::closed && checks_.rig_sound && found_.calibration_fits && lost_on_link() == 0 && !conforms;
  }

  std::uint64_t lost_on_link() const {
    const DutCounters& l = record_.link;
    return l.frames_dropped + l.frames_bad + l.indices_lost + l.overruns + l.naks;
  }

  void link() {
    const DutCounters& l = record_.link;
    const std::uint64_t bad = lost_on_link();
    Check& c = checks_.value_check(
        "link_intact", "Frames and samples lost on the link", static_cast<double>(bad), "1", 0.0, l.samples,
        {Limit::Kind::upper, 0.0, "ours: a sound link loses nothing"},
        fmt::format("{} dropped, {} bad, {} indices lost, {} overruns, {} NAK", l.frames_dropped,
                    l.frames_bad, l.indices_lost, l.overruns, l.naks));
    if (bad == 0) return;
    JudgedCheck& j = checks_.list.back();
    j.judgeable = false;
    c.verdict = Verdict::rig_error;
    c.blame = Blame::link;
    found_.link_sound = false;
    checks_.unsound(Blame::link);
  }

  const Plan& plan_;
  const PlanCase& planned_;
  const CaseRecord& record_;
  CaseChecks& checks_;
  JudgedCase& out_;
  InputsFound found_;
  bool charged_ = false;  ///< the build drove the force where the rig had to stop or to saturate
};

}  // namespace

InputsFound judge_inputs(const Plan& plan, const PlanCase& planned, const CaseRecord& record, CaseChecks& checks, JudgedCase& out) {
  return InputJudge(plan, planned, record, checks, out).run();
}

}  // namespace forcegate
