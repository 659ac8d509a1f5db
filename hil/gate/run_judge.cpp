#include "hil/gate/run_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hil/gate/case_result.h"
#include "hil/gate/decision.h"

namespace forcegate {
namespace {

const Check* rig_fault(const std::vector<JudgedCheck>& checks) {
  for (const JudgedCheck& j : checks)
    if (j.check.verdict == Verdict::rig_error) return &j.check;
  return nullptr;
}

Blame cut_short_by(const std::vector<JudgedCheck>& checks) {
  for (const JudgedCheck& j : checks)
    if (j.check.verdict == Verdict::inconclusive && !j.judgeable && j.check.blame != Blame::none) return j.check.blame;
  return Blame::user;
}

// Checks of others obey the order of a record's own: rig first. One of them that finds the rig at fault takes the record
// out of the judgement.
void add_checks(const std::vector<JudgedCheck>& others, JudgedCase& one) {
  const Check* const own = rig_fault(one.checks);
  const Blame blame = own != nullptr ? own->blame : Blame::rig;
  const bool at_fault = own != nullptr;
  for (JudgedCheck j : others) {
    if (!one.sound && j.judgeable) {
      j.judgeable = false;
      j.check.verdict = at_fault ? Verdict::rig_error : Verdict::inconclusive;
      j.check.blame = blame;
    }
    one.checks.push_back(std::move(j));
  }
  if (at_fault || charge_rig(one.checks) == nullptr) return;
  one.sound = false;
  one.maxima.usable = one.minima.usable = false;
}

}  // namespace

const Check* charge_rig(std::vector<JudgedCheck>& checks) {
  const Check* const found = rig_fault(checks);
  if (found == nullptr) return nullptr;
  for (JudgedCheck& j : checks)
    if (j.judgeable && j.check.id != "conformance") {
      j.judgeable = false;
      j.check.verdict = Verdict::rig_error;
      j.check.blame = found->blame;
    }
  return found;
}

std::vector<JudgedCheck*> all_checks(std::vector<JudgedCheck>& of_run, std::vector<PlayedRecord>& records) {
  std::vector<JudgedCheck*> all;
  for (JudgedCheck& check : of_run) all.push_back(&check);
  for (PlayedRecord& one : records)
    if (!one.superseded)
      for (JudgedCheck& check : one.judged.checks) all.push_back(&check);
  return all;
}

std::vector<JudgedCheck> judge_records(const Plan& plan, const DerivedLimits& limits,
                                       std::vector<PlayedRecord>& records, const ChecksByRecord& others) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    PlayedRecord& one = records[i];
    one.judged = judge_case(plan, plan.cases[one.case_index], one.record, limits);
    if (const auto at = others.find(i); at != others.end()) add_checks(at->second, one.judged);
  }
  std::vector<JudgedCheck> of_run;
  for (std::size_t k = 0; k < plan.cases.size(); ++k) {
    std::vector<SpecimenSessions> table;
    for (const std::string& specimen : specimens_of(plan, plan.cases[k])) table.push_back({specimen, {}});
    for (PlayedRecord& one : records)
      if (one.case_index == k && !one.superseded) table[one.specimen_index].sessions.push_back(&one.judged);
    for (JudgedCheck& check : judge_panel(plan, plan.cases[k], table)) of_run.push_back(std::move(check));
  }
  std::vector<JudgedCheck*> all = all_checks(of_run, records);
  apply_rule(plan.rule, all);
  return of_run;
}

void charge_compared(const Plan& plan, const std::vector<PlayedRecord>& records, std::vector<JudgedCheck>& of_run) {
  for (JudgedCheck& j : of_run) {
    if (!j.judgeable || !j.check.id.starts_with("no_worse_")) continue;
    for (const PlayedRecord& one : records) {
      if (one.superseded || one.judged.sound || !j.check.id.ends_with("/" + plan.cases[one.case_index].name)) continue;
      const Check* const rig = rig_fault(one.judged.checks);
      if (rig == nullptr && one.record.failure) continue;  // the record has no value at all
      j.judgeable = false;
      j.check.verdict = rig != nullptr ? Verdict::rig_error : Verdict::inconclusive;
      j.check.blame = rig != nullptr ? rig->blame : cut_short_by(one.judged.checks);
      j.check.evidence = fmt::format("{} {}", one.record.id, rig != nullptr ? "was spoiled by its rig" : "is no whole record on a calibration that fits");
      if (rig != nullptr) break;
    }
  }
}

std::vector<JudgedCheck> judge_material(RunMaterial& material, const ChecksByRecord& others) {
  std::vector<JudgedCheck> of_run = judge_records(material.plan, material.limits, material.records, others);
  of_run.insert(of_run.end(), material.compared.begin(), material.compared.end());
  if (material.compared.empty()) return of_run;
  charge_compared(material.plan, material.records, of_run);
  std::vector<JudgedCheck*> all = all_checks(of_run, material.records);
  apply_rule(material.plan.rule, all);  // again: the rule runs over all checks together
  return of_run;
}

namespace {

std::string attempt_suffix(int attempt) { return fmt::format("/attempt{}", attempt); }

CaseResult case_of(const Plan& plan, const PlayedRecord& one) {
  JudgedCase judged = one.judged;
  if (one.superseded)
    for (JudgedCheck& j : judged.checks) j.check.required = false;
  CaseResult c = to_case_result(plan.cases[one.case_index], one.job, one.record, judged, one.job.curves);
  c.attempts = one.job.attempt;
  if (!one.superseded) return c;
  c.id += attempt_suffix(one.job.attempt);
  for (Check& check : c.checks) check.case_id = c.id;
  c.note += fmt::format("{}the rig was at fault in attempt {}, a later attempt stands for this record",
                        c.note.empty() ? "" : "; ", one.job.attempt);
  return c;
}

}  // namespace

RunResult to_run_result(const RunMaterial& material, const std::vector<JudgedCheck>& of_run) {
  RunResult result = material.head;
  RunEvents events;
  events.level = material.level;
  events.cancelled = material.cancelled;
  events.of_recording = !material.head.rig.name.empty() && !material.head.rig.can_move;
  std::vector<const Check*> all;
  for (const JudgedCheck& check : of_run) all.push_back(&check.check);
  std::vector<const PlayedRecord*> order;
  for (const PlayedRecord& one : material.records) {
    order.push_back(&one);
    if (one.superseded) continue;
    const JudgedCase& j = one.judged;
    events.calibration_given = events.calibration_given || one.record.calibration_given;
    for (const JudgedCheck& check : j.checks) all.push_back(&check.check);
    events.cancelled = events.cancelled || j.cancelled;
    if (j.harness_error && !events.harness_error) {
      events.harness_error = true;
      events.harness_text = j.harness_text;
    }
    if (j.safety_stop) {
      if (!events.safety_stop || !j.safety_cause_decided) events.safety_text = j.safety_text;
      events.safety_stop = true;
      events.safety_cause_decided = events.safety_cause_decided && j.safety_cause_decided;
    }
  }
  result.decision = decide(all, material.plan.rule, events);
  for (const PlayedRecord& one : material.records) {
    const auto silent = [](const DutInfo& f) { return f.algorithm_id.empty() && f.board.empty() && f.build_id.empty(); };
    if (silent(one.record.firmware)) continue;
    const bool whole = !one.record.rig.name.empty();  // a crash leaves who crashed, and no more
    if (whole || silent(result.firmware)) result.firmware = one.record.firmware;
    if (!whole) continue;
    result.rig = one.record.rig;
    break;
  }
  for (const JudgedCheck& check : of_run) result.checks.push_back(check.check);
  std::stable_sort(order.begin(), order.end(), [](const PlayedRecord* a, const PlayedRecord* b) {
    return std::pair(a->case_index, a->specimen_index) < std::pair(b->case_index, b->specimen_index);
  });
  for (const PlayedRecord* one : order) result.cases.push_back(case_of(material.plan, *one));
  return result;
}

bool is_superseded(const CaseResult& result) { return result.id.ends_with(attempt_suffix(result.attempts)); }

}  // namespace forcegate
