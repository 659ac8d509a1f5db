#include "hil/gate/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/gate/blame.h"
#include "hil/gate/case_checks.h"
#include "hil/gate/input_checks.h"
#include "hil/gate/judge_accuracy.h"
#include "hil/gate/judged_extrema.h"
#include "hil/gate/judge_target.h"
#include "hil/gate/statistics.h"
#include "hil/interface/comparator.h"
#include "hil/rig/self_check.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kExtremaMissing = 0.02;

// Nobody reads the thirty digits of a float that ran away.
std::string force_text(double force_N) { return std::fabs(force_N) < 1e6 ? fmt::format("{:.3f}", force_N) : fmt::format("{:.4g}", force_N); }

// A slip in an id that is known; "" for one that is another algorithm's.
std::string meant_algorithm(const std::string& id) {
  std::vector<std::string> known;
  for (const ComparatorKind& kind : Registry<ComparatorKind>::instance().all()) known.insert(known.end(), kind.algorithms.begin(), kind.algorithms.end());
  return nearest_name(id, known);
}

// The extrema are those of the set-point: the reference has one where its force went there from the one before, if by less.
std::size_t extrema_of_reference(const CaseRecord& record) {
  constexpr double kOfSwing = 0.3;
  std::size_t out = 0;
  double setpoint_N = 0.0, ati_N = 0.0;  // unloaded, before the first
  for (const CasePair& p : record.pairs) {
    const double swing_N = p.setpoint_N - setpoint_N, followed_N = p.ati_N - ati_N;
    if (p.t_s >= record.facts.excitation_start_s && followed_N / swing_N >= kOfSwing) ++out;
    setpoint_N = p.setpoint_N, ati_N = p.ati_N;
  }
  return out;
}

class CaseJudge {
 public:
  CaseJudge(const Plan& plan, const PlanCase& planned, const CaseRecord& record, const DerivedLimits& limits)
      : plan_(plan), planned_(planned), record_(record), limits_(limits), checks_(record.id) {}

  JudgedCase run() {
    if (record_.failure) {
      failure();
      return finished();
    }
    rig();
    input();
    safety();
    coverage();
    link();
    out_.sound = checks_.rig_sound && checks_.complete;
    output();
    conformance();
    const Blame spoiled = !link_sound_ ? Blame::link : checks_.rig_sound ? Blame::none : checks_.rig_blame;
    for (JudgedCheck& check : judge_target(plan_, record_, spoiled)) checks_.list.push_back(std::move(check));
    judge_accuracy(plan_, planned_, record_, limits_, checks_, out_);
    hold();
    return finished();
  }

 private:
  JudgedCase finished() {
    out_.checks = std::move(checks_.list);
    return std::move(out_);
  }

  // Nothing further can be judged.
  void failure() {
    const CaseFailure& f = *record_.failure;
    const ErrorCode code = f.error.code;
    const std::string_view device = f.stage == CaseFailure::Stage::rig ? device_of(f.error.where) : std::string_view();
    const std::string text = (device.empty() ? "" : std::string(device) + ": ") + f.error.text + (f.error.hint.empty() ? "" : " (" + f.error.hint + ")");
    // An instrument that saw the firmware fail says so by its code: a board on the rig answers for the firmware too.
    const bool cancelled = code == ErrorCode::cancelled,
               firmware = f.stage == CaseFailure::Stage::firmware ||
                          (f.stage == CaseFailure::Stage::rig && code == ErrorCode::firmware);
    if (firmware && code == ErrorCode::firmware) {
      checks_.final_check("firmware_runs", "The firmware answers every sample", Verdict::fail,
                          Blame::firmware, text);
    } else if (firmware && code != ErrorCode::internal && !cancelled) {
      checks_.final_check("firmware_runs", "The firmware answers every sample", Verdict::rig_error,
                          Blame::link, text);
    } else if (f.stage == CaseFailure::Stage::rig && !cancelled) {
      checks_.final_check("rig_runs", "The rig plays the record", Verdict::rig_error,
                          f.blame == Blame::none ? blame_of_device(f.error.where) : f.blame, text);
    } else {
      out_.cancelled = cancelled;
      out_.harness_error = !cancelled && f.stage != CaseFailure::Stage::setup;
      if (out_.harness_error) out_.harness_text = text;
      checks_.final_check("record", "Record", Verdict::not_run,
                          out_.harness_error ? Blame::harness : code == ErrorCode::firmware ? Blame::firmware : Blame::user,
                          cancelled ? "interrupted" : text);
    }
  }

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
      if (c.verdict == Verdict::inconclusive) calibration_fits_ = false;
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
          out_.safety_text + "; motor, spring witness and link are sound and the firmware had left the ATI");
    } else {
      out_.safety_cause_decided = false;
      checks_.final_check("safety_stop", "No safety stop", Verdict::inconclusive, Blame::rig,
                          out_.safety_text + "; the cause is not decided");
    }
  }

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
    extrema_count();
    if (calibration_fits_ || !checks_.complete) return;
    checks_.complete = false;
    checks_.incomplete_blame = Blame::calibration;
  }

  void extrema_count() {
    const auto expected = static_cast<double>(record_.expected_extrema);
    if (expected < 4.0 || !checks_.complete) return;
    const auto found = static_cast<double>(extrema_of_reference(record_));
    const double missing = std::max(0.0, (expected - found - 2.0) / expected);
    if (missing > kExtremaMissing) checks_.complete = false, checks_.incomplete_blame = Blame::rig;
    checks_.value_check("extrema_count", "Share of the profile's extrema that are missing", missing, "1", 0.0,
                        record_.expected_extrema,
                        {Limit::Kind::upper, kExtremaMissing, "ours: the profile was played"},
                        fmt::format("the reference followed {:.0f} of {:.0f} extrema of the profile", found, expected));
  }

  void link() {
    const DutCounters& l = record_.link;
    const std::uint64_t bad = l.frames_dropped + l.frames_bad + l.indices_lost + l.overruns + l.naks;
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
    link_sound_ = false;
    checks_.unsound(Blame::link);
  }

  void output() {
    const OutputFacts& o = record_.output;
    checks_.value_check(
        "output_finite", "Samples that are not a number", static_cast<double>(o.not_finite), "1", 0.0,
        record_.samples, {Limit::Kind::upper, 0.0, "ours: every sample is a number"},
        o.not_finite == 0 ? "every sample is finite"
                          : fmt::format("{} samples are NaN or infinite, the first at {:.3f} s", o.not_finite,
                                        o.first_not_finite_s));
    checks_.judge_even_if_incomplete();
    checks_.value_check(
        "output_bounded", "Largest force the firmware reported",
        std::isnan(o.minimum_N + o.maximum_N) ? kNan
                                              : std::max(std::fabs(o.minimum_N), std::fabs(o.maximum_N)),
        "N", 0.0, record_.samples, {Limit::Kind::upper, plan_.limits.output_max_N, "ours: plan"},
        fmt::format("{} to {} N", force_text(o.minimum_N), force_text(o.maximum_N)));
    if (calibration_fits_) checks_.judge_even_if_incomplete();
    spikes();
    // What lies before the end of the first window is not judged. One that begins later than it may last is no start window: all that it takes
    // out counts. (When a recording's own excitation began is known only roughly.)
    const double taken_out_s = std::max(0.0, o.learning_end_s - record_.facts.excitation_start_s);
    const bool late = taken_out_s - o.learning_longest_s > plan_.limits.learning_s;
    if (record_.facts.dynamic || taken_out_s > 0.0)
      checks_.value_check("learning_window", "Longest start window", late ? taken_out_s : o.learning_longest_s, "s", 0.0,
                          record_.samples, {Limit::Kind::upper, plan_.limits.learning_s, "ours: plan"},
                          fmt::format("the first window closed at {:.2f} s", o.learning_end_s));
    if (record_.facts.dynamic) lag();
  }

  void spikes() {
    const OutputFacts& o = record_.output;
    if (!std::isfinite(o.spike_N)) return;  // too few samples a second to tell a spike from a turn of the force
    checks_.value_check("output_spike", "Largest spike of the output where the code has none", o.spike_N, "N", 0.0, record_.samples,
                        {Limit::Kind::upper, plan_.limits.spike_max_N, "ours: plan"},
                        o.spike_N > 0.0 ? fmt::format("at {:.3f} s, against the samples 10 ms before and after it", o.spike_t_s) : "none");
    checks_.judge_even_if_incomplete();
  }

  void lag() {
    const double limit_s = plan_.limits.lag_s, period_s = shortest_period_s(record_.pairs, record_.facts.excitation_start_s);
    const bool known = std::isfinite(record_.lag_s);
    checks_.value_check("lag", "Distance in time between firmware and ATI", std::fabs(record_.lag_s), "s", known ? record_.u_lag_s : 0.0,
                        record_.samples, {Limit::Kind::upper, limit_s, "ours: plan"},
                        !known ? "cannot be told: the ATI's force hardly moves, or the output does not follow it"
                               : fmt::format("the firmware is {:.1f} ms {} the ATI", 1000.0 * std::fabs(record_.lag_s),
                                             record_.lag_s < 0.0 ? "ahead of" : "behind"));
    JudgedCheck& j = checks_.list.back();
    if (known && j.judgeable && beside_the_codes(j.check)) {
      j.judgeable = false;
      return;
    }
    if (!known || !j.judgeable || !(0.5 * period_s <= limit_s + coverage_factor(plan_.rule.coverage_per_look(), 0.0) * record_.u_lag_s)) return;
    // A delay by whole periods looks like none at all.
    j.judgeable = false;
    j.check.verdict = Verdict::inconclusive;
    j.check.blame = Blame::user;
    j.check.evidence += fmt::format(", or that and whole periods of {:.3g} ms: half a period is no more than the limit of {:.3g} ms and its uncertainty; play a slower profile",
                                    1000.0 * period_s, 1000.0 * limit_s);
  }

  // What the codes bring along is not the firmware's: of a lag beyond the limit it is taken off, and where the ATI's reading
  // is the late one it is added to one inside. Where that turns the verdict there is none.
  bool beside_the_codes(Check& c) const {
    const double codes_s = record_.raw_lag_s, own_s = record_.lag_s - codes_s, limit_s = plan_.limits.lag_s;
    if (!std::isfinite(codes_s)) return false;
    const bool link = c.value > limit_s && std::fabs(own_s) <= limit_s, reference = c.value <= limit_s && codes_s < 0.0 && own_s > limit_s;
    if (!link && !reference) return false;
    c.verdict = Verdict::inconclusive;
    c.blame = codes_s < 0.0 ? Blame::reference : Blame::link;
    c.evidence += fmt::format(", but {:.1f} ms behind its codes, which are {:.1f} ms {} the ATI", 1000.0 * own_s, 1000.0 * std::fabs(codes_s), codes_s < 0.0 ? "ahead of" : "behind");
    return true;
  }

  void conformance() {
    if (!(planned_.checks & kCheckConformance)) return;
    if (!record_.conformance_known) return without_oracle();
    checks_.value_check("conformance", "Conformance with the declared algorithm", record_.conformance,
                        record_.conformance_unit, 0.0, record_.conformance_n,
                        {Limit::Kind::upper, record_.conformance_limit, record_.conformance_source},
                        record_.conformance_evidence);
    // Arithmetic does not depend on the rig: on a sound link the same codes went to both.
    JudgedCheck& j = checks_.list.back();
    if (link_sound_ && std::isfinite(record_.conformance) && !j.judgeable &&
        record_.conformance > record_.conformance_limit) {
      j.judgeable = true;
      j.check.blame = Blame::firmware;
    }
  }

  // What the plan asks for by name is owed. An algorithm of its own is let off only where the plan judges its values, and the
  // decision says so: a slip in the id, or none, switches nothing off.
  void without_oracle() {
    const std::string& id = record_.firmware.algorithm_id;
    const auto values = [](const PlanCase& c) { return (c.checks & (kCheckAccuracy | kCheckPromise)) != 0; };
    const bool judged = values(planned_) || std::any_of(plan_.cases.begin(), plan_.cases.end(), values);
    const std::string meant = id.find('+') == std::string::npos ? meant_algorithm(id) : std::string();  // "KNOWN+NAME" extends one
    Check& c = checks_.final_check("conformance", "Conformance with the declared algorithm", Verdict::not_run, Blame::user,
                                   fmt::format("no independent implementation of '{}' is known", id));
    if (!id.empty() && meant.empty() && judged) {
      c.required = false;
      c.blame = Blame::none;
      c.evidence += ", its values alone are judged";
    } else if (id.empty() || !meant.empty()) {
      c.blame = Blame::firmware;
      c.evidence += meant.empty() ? ": the image announces no algorithm" : "; is '" + meant + "' meant?";
    } else {
      c.evidence += ", and no case of the plan judges values: add the check 'accuracy', or sign a waiver (--waivers)";
    }
  }

  void hold() {
    if (!(planned_.checks & kCheckHold)) return;
    const HoldFacts& h = record_.hold;
    if (!out_.sound) {
      checks_.value_check("hold_amplification", "Amplification of a static hold", kNan, "%", 0.0, 0,
                          {Limit::Kind::upper, plan_.limits.hold_pct, "ours: plan"},
                          "the record is not whole and sound");
      return;
    }
    if (h.seconds <= 0.0 || !(std::fabs(h.raw_N) > 0.05)) {
      checks_.final_check("hold_amplification", "Amplification of a static hold", Verdict::not_run,
                          Blame::user, "the profile holds no force for more than 30 s after cycling");
      return;
    }
    const double excess_pct = 100.0 * (h.dut_N / h.raw_N - 1.0);
    checks_.value_check(
        "hold_amplification", "Amplification of a static hold", std::fabs(excess_pct), "%", 0.0, 1,
        {Limit::Kind::upper, plan_.limits.hold_pct, "ours: plan"},
        fmt::format("firmware {:.3f} N, static law {:.3f} N, ATI {:.3f} N over {:.0f} s of hold", h.dut_N,
                    h.raw_N, h.ati_N, h.seconds));
  }

  const Plan& plan_;
  const PlanCase& planned_;
  const CaseRecord& record_;
  const DerivedLimits& limits_;
  CaseChecks checks_;
  JudgedCase out_;
  bool link_sound_ = true, charged_ = false;
  bool calibration_fits_ = true;  ///< the one that was given, as far as the record tells
};

}  // namespace

JudgedCase judge_case(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                      const DerivedLimits& limits) {
  return CaseJudge(plan, planned, record, limits).run();
}

}  // namespace forcegate
