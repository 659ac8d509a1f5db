#include "hil/characterize/capacitance/weight_material.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "hil/gate/decision.h"
#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

// The image did not answer to the end: nothing else is known of it. As firmware_runs of a case gate: what is not the firmware's is
// the link's, and our own defect nobody's verdict.
JudgedCheck no_session(const Error& error, const std::string& case_id) {
  const bool firmware = error.code == ErrorCode::firmware, ours = error.code == ErrorCode::internal, cancelled = error.code == ErrorCode::cancelled;
  JudgedCheck j;
  j.judgeable = false;
  j.check = {.id = "session",
             .case_id = case_id,
             .title = "The image answers to the end of its session",
             .value = std::numeric_limits<double>::quiet_NaN(),
             .unit = {},
             .limit = {},
             .verdict = firmware ? Verdict::fail : ours || cancelled ? Verdict::not_run : Verdict::rig_error,
             .blame = firmware ? Blame::firmware : ours ? Blame::harness : cancelled ? Blame::user : Blame::link,
             .evidence = cancelled ? "interrupted" : error.text};
  return j;
}

PlotTrace curve(const char* name, const WeightGatePlan& plan, const std::vector<double>& force_N) {
  PlotTrace out{name, "N", {}, {}};
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    out.t_s.push_back(static_cast<float>(plan.frame_end_s(i)));
    out.value.push_back(static_cast<float>(force_N[i]));
  }
  return out;
}

// The levels of the loadings: weights, firmware, conductance model.
ExtremaSeries levels_of(const WeightGatePlan& plan, const SensorRecord& record) {
  ExtremaSeries out;
  out.name = "levels";
  for (std::size_t i = 0; i < record.answers.force_N.size(); ++i) {
    if (record.frames.loading[i] >= plan.loadings) continue;
    out.t_s.push_back(static_cast<float>(plan.frame_end_s(i)));
    out.expected_N.push_back(static_cast<float>(record.frames.force_N[i]));
    out.actual_N.push_back(static_cast<float>(record.answers.force_N[i]));
    out.raw_N.push_back(static_cast<float>(record.frames.conductance_N[i]));
  }
  return out;
}

}  // namespace

std::vector<JudgedCheck*> all_checks(std::vector<JudgedCheck>& of_run, std::vector<SensorRecord>& records) {
  std::vector<JudgedCheck*> all;
  for (JudgedCheck& check : of_run) all.push_back(&check);
  for (SensorRecord& one : records)
    for (JudgedCheck& check : one.checks) all.push_back(&check);
  return all;
}

std::vector<JudgedCheck> judge_material(WeightMaterial& m, const ChecksByRecord& others) {
  bool complete = m.records.size() == m.sensors;
  const Check* spoiled = nullptr;
  std::vector<const SensorFrames*> frames;
  std::vector<const FrameAnswers*> answers;
  for (std::size_t i = 0; i < m.records.size(); ++i) {
    SensorRecord& one = m.records[i];
    const std::string& id = m.head.cases[i].id;
    one.checks.clear();
    if (one.failure) {
      one.checks.push_back(no_session(*one.failure, id));
      complete = false;
      continue;
    }
    one.checks = judge_sensor(m.plan, one.frames, one.answers, id);
    if (const auto at = others.find(i); at != others.end())
      one.checks.insert(one.checks.end(), at->second.begin(), at->second.end());
    if (const Check* found = charge_rig(one.checks)) spoiled = found;
    frames.push_back(&one.frames);
    answers.push_back(&one.answers);
  }
  std::vector<JudgedCheck> of_run;
  if (complete) of_run = judge_pack(m.plan, frames, answers);
  if (m.with_accepted && complete) of_run.push_back(compare_with_accepted(m));
  if (spoiled != nullptr)
    for (JudgedCheck& j : of_run)
      j.judgeable = false, j.check.verdict = Verdict::rig_error, j.check.blame = spoiled->blame;
  std::vector<JudgedCheck*> all = all_checks(of_run, m.records);
  apply_rule(m.plan.rule, all);
  return of_run;
}

RunResult to_run_result(const WeightMaterial& m, const std::vector<JudgedCheck>& of_run) {
  RunResult result = m.head;
  RunEvents events;
  events.cancelled = m.cancelled;
  std::vector<const Check*> all;
  for (const JudgedCheck& j : of_run) {
    all.push_back(&j.check);
    result.checks.push_back(j.check);
  }
  for (std::size_t i = 0; i < m.records.size(); ++i) {
    const SensorRecord& one = m.records[i];
    CaseResult& c = result.cases[i];
    for (const JudgedCheck& j : one.checks) {
      all.push_back(&j.check);
      c.checks.push_back(j.check);
    }
    if (one.failure) {
      c.note = one.failure->to_text();
      if (one.failure->code == ErrorCode::internal && !events.harness_error)
        events.harness_error = true, events.harness_text = one.failure->text;
      events.cancelled = events.cancelled || one.failure->code == ErrorCode::cancelled;
      continue;
    }
    c.overview = {curve("weights", m.plan, one.frames.force_N),
                  curve("firmware", m.plan, one.answers.force_N)};
    c.extrema = {levels_of(m.plan, one)};
  }
  result.decision = decide(all, m.plan.rule, events);
  return result;
}

JudgedCheck compare_with_accepted(const WeightMaterial& m) {
  JudgedCheck j;
  Check& c = j.check;
  c.id = "no_worse_per";
  c.title = "Loss of error reduction, eq. (11), against the accepted build";
  c.unit = "%";
  c.limit = {Limit::Kind::upper, m.plan.loss_pct, "ours: plan, percentage points"};
  c.blame = Blame::firmware;
  double sum = 0.0, squares = 0.0, fourths = 0.0, worst = -std::numeric_limits<double>::infinity();
  std::string at;
  for (std::size_t i = 0; i < m.records.size(); ++i) {
    const SensorRecord& one = m.records[i];
    if (one.failure || one.accepted_N.size() != one.answers.force_N.size()) {
      c.value = std::numeric_limits<double>::quiet_NaN();
      c.evidence = "not every sensor of the two builds has its partner: " + m.head.cases[i].id;
      if (one.failure) return j;
      j.judgeable = false;  // nothing to compare with says nothing of the candidate
      c.verdict = Verdict::not_run;
      c.blame = Blame::user;
      c.evidence = "the accepted build gives no answer for " + m.head.cases[i].id + "; give one that runs (--accepted)";
      return j;
    }
    const auto own = squared_error_by_loading_N2(m.plan, one.frames, one.answers.force_N),
               theirs = squared_error_by_loading_N2(m.plan, one.frames, one.accepted_N);
    const double line_N2 =
        moments(squared_error_by_loading_N2(m.plan, one.frames, one.frames.conductance_N)).mean;
    std::vector<double> loss;
    for (std::size_t l = 0; l < own.size(); ++l) loss.push_back(100.0 * (own[l] - theirs[l]) / line_N2);
    const Moments of_sensor = moments(loss);
    sum += of_sensor.mean;
    const double square = of_sensor.sd * of_sensor.sd / static_cast<double>(of_sensor.n);
    squares += square;
    fourths += square * square / (static_cast<double>(of_sensor.n) - 1.0);
    if (of_sensor.mean > worst) worst = of_sensor.mean, at = m.head.cases[i].id;
  }
  const auto n = static_cast<double>(m.records.size());
  c.value = sum / n;
  c.u = std::sqrt(squares) / n;
  if (fourths > 0.0) j.dof = squares * squares / fourths;  // Welch and Satterthwaite
  c.n = m.records.size();
  c.evidence = fmt::format("{} sensors, worst {:+.3f} points on {}", m.records.size(), worst, at);
  return j;
}

}  // namespace forcegate::characterize
