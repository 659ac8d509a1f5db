#include "hil/gate/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/gate/blame.h"
#include "hil/gate/input_checks.h"
#include "hil/gate/judge_target.h"
#include "hil/gate/judged_extrema.h"
#include "hil/gate/statistics.h"
#include "hil/rig/self_check.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kExtremaMissing = 0.02;
constexpr std::size_t kExtremaNeeded = 4;  // two of each kind: one has no spread
constexpr double kExtremumFloor_N = 0.1;  // below, a relative error says nothing

class CaseJudge {
 public:
  CaseJudge(const Plan& plan, const PlanCase& planned, const CaseRecord& record, const DerivedLimits& limits)
      : plan_(plan), planned_(planned), record_(record), limits_(limits) {}

  JudgedCase run() {
    if (record_.failure) {
      failure();
      return std::move(out_);
    }
    rig();
    input();
    safety();
    coverage();
    link();
    out_.sound = rig_sound_ && complete_;
    output();
    conformance();
    const Blame spoiled = !link_sound_ ? Blame::link : rig_sound_ ? Blame::none : rig_blame_;
    for (JudgedCheck& check : judge_target(plan_, record_, spoiled)) out_.checks.push_back(std::move(check));
    values();
    hold();
    return std::move(out_);
  }

 private:
  Check& final_check(std::string id, std::string title, Verdict verdict, Blame blame, std::string evidence) {
    JudgedCheck j;
    j.judgeable = false;
    j.check.id = std::move(id);
    j.check.case_id = record_.id;
    j.check.title = std::move(title);
    j.check.value = kNan;
    j.check.verdict = verdict;
    j.check.blame = blame;
    j.check.evidence = std::move(evidence);
    out_.checks.push_back(std::move(j));
    return out_.checks.back().check;
  }

  // A value against a limit; when the record cannot carry a judgement the verdict says why instead.
  Check& value_check(std::string id, std::string title, double value, std::string unit, double u,
                     std::uint64_t n, Limit limit, std::string evidence) {
    JudgedCheck j;
    Check& c = j.check;
    c.id = std::move(id);
    c.case_id = record_.id;
    c.title = std::move(title);
    c.value = value;
    c.unit = std::move(unit);
    c.u = u;
    c.n = n;
    c.limit = std::move(limit);
    c.evidence = std::move(evidence);
    if (c.limit.kind == Limit::Kind::none) c.required = false;
    if (!rig_sound_) {
      j.judgeable = false;
      c.verdict = Verdict::rig_error;
      c.blame = rig_blame_;
    } else if (!complete_ && c.limit.kind != Limit::Kind::none) {
      j.judgeable = false;
      c.verdict = Verdict::inconclusive;
      c.blame = incomplete_blame_;
    }
    out_.checks.push_back(std::move(j));
    return out_.checks.back().check;
  }

  // Nothing further can be judged.
  void failure() {
    const CaseFailure& f = *record_.failure;
    const ErrorCode code = f.error.code;
    const std::string text = f.error.text + (f.error.hint.empty() ? "" : " (" + f.error.hint + ")");
    const bool cancelled = code == ErrorCode::cancelled, firmware = f.stage == CaseFailure::Stage::firmware;
    if (firmware && code == ErrorCode::firmware) {
      final_check("firmware_runs", "The firmware answers every sample", Verdict::fail, Blame::firmware, text);
    } else if (firmware && code != ErrorCode::internal && !cancelled) {
      final_check("firmware_runs", "The firmware answers every sample", Verdict::rig_error, Blame::link, text);
    } else if (f.stage == CaseFailure::Stage::rig && !cancelled) {
      final_check("rig_runs", "The rig plays the record", Verdict::rig_error,
                  f.blame == Blame::none ? blame_of_device(f.error.where) : f.blame, text);
    } else {
      out_.cancelled = cancelled;
      out_.harness_error = !cancelled && f.stage != CaseFailure::Stage::setup;
      if (out_.harness_error) out_.harness_text = text;
      final_check("record", "Record", Verdict::not_run, out_.harness_error ? Blame::harness : Blame::user,
                  cancelled ? "interrupted" : text);
    }
  }

  void rig() {
    std::vector<Check> checks = self_check(record_.rig, record_.observed, plan_.self_check);
    const bool closed = planned_.loop == LoopMode::closed;
    const RigObservation& o = record_.observed;
    for (Check& c : checks) {
      if (c.verdict == Verdict::pass) continue;
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
      unsound(c.blame);
    }
    for (Check& c : checks) keep(std::move(c));
  }

  // The first cause is the one to name: later findings follow from it.
  void unsound(Blame blame) {
    if (rig_sound_) rig_blame_ = blame;
    rig_sound_ = false;
  }

  void input() {
    for (Check& c : input_checks(plan_, record_)) {
      if (c.verdict != Verdict::pass) unsound(c.blame);
      keep(std::move(c));
    }
  }

  void keep(Check c) {
    c.case_id = record_.id;
    out_.checks.push_back({std::move(c), 0.0, false});
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
    if (!rig_sound_ || rig_reason) {
      rig_sound_ = false;
      final_check("safety_stop", "No safety stop", Verdict::rig_error,
                  rig_blame_ == Blame::none ? Blame::rig : rig_blame_, out_.safety_text);
    } else if (closed && firmware_left_the_reference(record_)) {
      charged_ = true;
      final_check(
          "safety_stop", "No safety stop", Verdict::fail, Blame::firmware,
          out_.safety_text + "; motor, spring witness and link are sound and the firmware had left the ATI");
    } else {
      out_.safety_cause_decided = false;
      final_check("safety_stop", "No safety stop", Verdict::inconclusive, Blame::rig,
                  out_.safety_text + "; the cause is not decided");
    }
  }

  void coverage() {
    const double expected = static_cast<double>(record_.expected_samples);
    const double missing = expected > 0.0 ? 1.0 - static_cast<double>(record_.samples) / expected : kNan;
    complete_ = missing == 0.0;
    if (record_.observed.time_not_monotone > 0) {
      unsound(Blame::link);
      final_check("time_base", "Time runs forward", Verdict::rig_error, Blame::link,
                  fmt::format("time does not advance {} times", record_.observed.time_not_monotone));
    }
    if (!complete_) incomplete_blame_ = charged_ ? Blame::firmware : Blame::link;
    const std::uint64_t have = record_.samples, want = record_.expected_samples;
    Check& c = value_check("coverage", "Share of the record that is missing", missing, "1", 0.0, want,
                           {Limit::Kind::upper, 0.0, "ours: a record is whole"},
                           complete_ ? fmt::format("{} samples, {:.0f} s", have, record_.duration_s)
                                     : fmt::format("the record is truncated: {} of {} samples", have, want));
    if (!complete_ && charged_) c.required = false;  // the stop itself is the finding
    extrema_count();
  }

  void extrema_count() {
    const auto expected = static_cast<double>(record_.expected_extrema);
    if (expected < 4.0 || !complete_) return;
    const double found =
        static_cast<double>(std::count_if(record_.pairs.begin(), record_.pairs.end(), [&](const CasePair& p) {
          return p.t_s >= record_.facts.excitation_start_s;
        }));
    const double missing = std::max(0.0, (expected - found - 2.0) / expected);
    if (missing > kExtremaMissing) complete_ = false, incomplete_blame_ = Blame::rig;
    value_check("extrema_count", "Share of the profile's extrema that are missing", missing, "1", 0.0,
                record_.expected_extrema,
                {Limit::Kind::upper, kExtremaMissing, "ours: the profile was played"},
                fmt::format("{:.0f} extrema found, {:.0f} in the profile", found, expected));
  }

  void link() {
    const DutCounters& l = record_.link;
    const std::uint64_t bad = l.frames_dropped + l.frames_bad + l.indices_lost + l.overruns + l.naks;
    Check& c = value_check("link_intact", "Frames and samples lost on the link", static_cast<double>(bad),
                           "1", 0.0, l.samples, {Limit::Kind::upper, 0.0, "ours: a sound link loses nothing"},
                           fmt::format("{} dropped, {} bad, {} indices lost, {} overruns, {} NAK",
                                       l.frames_dropped, l.frames_bad, l.indices_lost, l.overruns, l.naks));
    if (bad == 0) return;
    JudgedCheck& j = out_.checks.back();
    j.judgeable = false;
    c.verdict = Verdict::rig_error;
    c.blame = Blame::link;
    link_sound_ = false;
    unsound(Blame::link);
  }

  // What the firmware did wrong in a part of a record on a sound rig stays wrong.
  void judge_even_if_incomplete() {
    JudgedCheck& j = out_.checks.back();
    if (rig_sound_ && !complete_ && j.check.value > j.check.limit.value) {
      j.judgeable = true;
      j.check.blame = Blame::firmware;
    }
  }

  void output() {
    const OutputFacts& o = record_.output;
    value_check("output_finite", "Samples that are not a number", static_cast<double>(o.not_finite), "1", 0.0,
                record_.samples, {Limit::Kind::upper, 0.0, "ours: every sample is a number"},
                o.not_finite == 0 ? "every sample is finite"
                                  : fmt::format("{} samples are NaN or infinite, the first at {:.3f} s",
                                                o.not_finite, o.first_not_finite_s));
    judge_even_if_incomplete();
    value_check("output_bounded", "Largest force the firmware reported",
                std::isnan(o.minimum_N + o.maximum_N) ? kNan
                                                      : std::max(std::fabs(o.minimum_N), std::fabs(o.maximum_N)),
                "N", 0.0, record_.samples,
                {Limit::Kind::upper, plan_.limits.output_max_N, "ours: plan"},
                fmt::format("{:.3f} to {:.3f} N", o.minimum_N, o.maximum_N));
    judge_even_if_incomplete();
    if (record_.facts.dynamic)
      value_check("learning_window", "Longest start window", o.learning_longest_s, "s", 0.0, record_.samples,
                  {Limit::Kind::upper, plan_.limits.learning_s, "ours: plan"},
                  fmt::format("the first window closed at {:.2f} s", o.learning_end_s));
    if (record_.facts.dynamic && std::isfinite(record_.lag_s))
      value_check("lag", "Lag of the firmware behind the ATI", std::fabs(record_.lag_s), "s", record_.u_lag_s,
                  record_.samples, {Limit::Kind::upper, plan_.limits.lag_s, "ours: plan"},
                  fmt::format("{:+.1f} ms", 1000.0 * record_.lag_s));
  }

  void conformance() {
    if (!(planned_.checks & kCheckConformance)) return;
    if (!record_.conformance_known) {
      final_check(
          "conformance", "Conformance with the declared algorithm", Verdict::not_run, Blame::none,
          fmt::format("no independent implementation of '{}' is known", record_.firmware.algorithm_id))
          .required = false;
      return;
    }
    value_check("conformance", "Conformance with the declared algorithm", record_.conformance,
                record_.conformance_unit, 0.0, record_.conformance_n,
                {Limit::Kind::upper, record_.conformance_limit, record_.conformance_source},
                record_.conformance_evidence);
    // Arithmetic does not depend on the rig: on a sound link the same codes went to both.
    JudgedCheck& j = out_.checks.back();
    if (link_sound_ && std::isfinite(record_.conformance) && !j.judgeable &&
        record_.conformance > record_.conformance_limit) {
      j.judgeable = true;
      j.check.blame = Blame::firmware;
    }
  }

  Limit limit_of(const std::string& id, const std::optional<double>& given) const {
    if (given) return {Limit::Kind::upper, *given, planned_.limit_source};
    return limits_.find(planned_.name, id);
  }

  void values() {
    if (const std::size_t n = record_.pairs.size(); planned_.checks & kCheckAccuracy && n < kExtremaNeeded)
      final_check("accuracy", "Extrema to judge the accuracy on", Verdict::not_run, Blame::user,
                  fmt::format("the record holds {} extrema, an accuracy needs {}", n, kExtremaNeeded));
    if (!record_.facts.dynamic && record_.pairs.empty()) return;
    const bool closed = planned_.loop == LoopMode::closed;
    const char* against = closed ? "ATI against set-point" : "firmware against ATI";
    // A recording's own force channel begins with the loading: its bounds say nothing about the settled
    // minima.
    const double low_N = record_.rig.can_move ? record_.facts.mean_N - record_.facts.amplitude_N
                                              : moments(judged_extrema(planned_, record_, false).expected).mean;
    for (const bool maximum : {true, false}) {
      const JudgedExtrema s = judged_extrema(planned_, record_, maximum);
      const char* which = maximum ? "maxima" : "minima";
      const RelativeError e = mean_relative_error(s.actual, s.expected, kExtremumFloor_N);
      const double typical_N = std::fabs(moments(s.expected).mean);
      const std::size_t items = e.n + e.left_out;
      const Budget relative =
          mre_budget(plan_.uncertainty, record_, typical_N, e.standard_error, e.n, planned_.half_width_s);
      const Budget absolute = mae_budget(plan_.uncertainty, record_, typical_N, items, planned_.half_width_s);
      const bool judge_relative = maximum || low_N >= plan_.limits.minima_floor_N;
      const std::string mre_id = fmt::format("mre_{}", which), mae_id = fmt::format("mae_{}", which);
      const std::string tail =
          planned_.tail_s > 0.0 ? fmt::format(" over the last {:.0f} s", planned_.tail_s) : "";
      const std::string mre_title = fmt::format("Mean relative error of the {}, {}{}", which, against, tail);
      const std::string mae_title = fmt::format("Mean absolute error of the {}, {}{}", which, against, tail);
      const std::string evidence = fmt::format("{} {}, largest {:.2f} %; u from {}", e.n, which,
                                               100.0 * e.largest, relative.to_text());
      // A few extrema may fall into a gap of the reference; more, and their mean is not that of the record.
      const bool whole = static_cast<double>(e.not_finite) <= kExtremaMissing * static_cast<double>(s.expected.size());
      const double mre = whole ? 100.0 * e.mean : kNan, mae = whole ? e.mean_absolute : kNan;
      if (closed) {
        PanelValue& panel = maximum ? out_.maxima : out_.minima;
        panel.usable = rig_sound_ && complete_ && e.not_finite == 0 && e.n > 0;
        panel.value = judge_relative ? mre : mae;
        panel.unit = judge_relative ? "%" : "N";
        panel.u_systematic = judge_relative ? relative.u_systematic() : absolute.u_systematic();
      }
      const bool wanted = planned_.checks & kCheckAccuracy && !closed;
      const Limit none{};
      const std::string judged_id = judge_relative ? mre_id : mae_id;
      const std::optional<double> given = maximum ? planned_.maxima_pct : planned_.minima_pct;
      const Limit limit = wanted ? limit_of(judged_id, judge_relative ? given : std::nullopt) : none;
      const bool derived = wanted && !(judge_relative && given);
      value_check(mre_id, mre_title, mre, "%", derived ? relative.u_random() : relative.u(), e.n,
                  judge_relative ? limit : none, evidence);
      repeatable(derived ? 0.0 : relative.u_systematic());
      value_check(mae_id, mae_title, mae, "N", derived ? absolute.u_random() : absolute.u(),
                  items, judge_relative ? none : limit, fmt::format("{} {}", items, which));
      repeatable(derived ? 0.0 : absolute.u_systematic());
      if (wanted && limit.kind == Limit::Kind::none)
        final_check("accuracy_" + std::string(which), judge_relative ? mre_title : mae_title,
                    Verdict::not_run, Blame::user,
                    fmt::format("there is no limit for {} of {}: derive limits first (forcegate limits)",
                                judged_id, planned_.name));
    }
  }

  void repeatable(double u_systematic) {
    out_.checks.back().repeatable = out_.checks.back().judgeable;
    out_.checks.back().u_systematic = u_systematic;
  }

  void hold() {
    if (!(planned_.checks & kCheckHold)) return;
    const HoldFacts& h = record_.hold;
    if (!out_.sound) {
      value_check("hold_amplification", "Amplification of a static hold", kNan, "%", 0.0, 0,
                  {Limit::Kind::upper, plan_.limits.hold_pct, "ours: plan"},
                  "the record is not whole and sound");
      return;
    }
    if (h.seconds <= 0.0 || !(std::fabs(h.raw_N) > 0.05)) {
      final_check("hold_amplification", "Amplification of a static hold", Verdict::not_run, Blame::user,
                  "the profile holds no force for more than 30 s after cycling");
      return;
    }
    const double excess_pct = 100.0 * (h.dut_N / h.raw_N - 1.0);
    value_check("hold_amplification", "Amplification of a static hold", std::fabs(excess_pct), "%", 0.0, 1,
                {Limit::Kind::upper, plan_.limits.hold_pct, "ours: plan"},
                fmt::format("firmware {:.3f} N, static law {:.3f} N, ATI {:.3f} N over {:.0f} s of hold",
                            h.dut_N, h.raw_N, h.ati_N, h.seconds));
  }

  const Plan& plan_;
  const PlanCase& planned_;
  const CaseRecord& record_;
  const DerivedLimits& limits_;
  JudgedCase out_;
  bool rig_sound_ = true, link_sound_ = true, complete_ = true, charged_ = false;
  Blame rig_blame_ = Blame::none, incomplete_blame_ = Blame::none;
};

}  // namespace

JudgedCase judge_case(const Plan& plan, const PlanCase& planned, const CaseRecord& record,
                      const DerivedLimits& limits) {
  return CaseJudge(plan, planned, record, limits).run();
}

}  // namespace forcegate
