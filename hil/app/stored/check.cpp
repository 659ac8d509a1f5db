#include "hil/app/stored/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/files/find_plan.h"
#include "hil/app/gate/repeats.h"
#include "hil/app/gate/weight_gate.h"
#include "hil/app/play/worker.h"
#include "hil/base/plain_number.h"
#include "hil/base/read_file.h"
#include "hil/gate/case_json.h"
#include "hil/gate/case_result.h"
#include "hil/gate/remeasure.h"
#include "hil/interface/comparator.h"
#include "hil/report/result_json.h"
#include "hil/trace/hdf5_io.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

using characterize::WeightMaterial;

std::unique_ptr<Comparator> comparator_for(const CaseRecord& record) {
  if (!record.conformance_known) return nullptr;
  const ComparatorKind* kind = comparator_of(record.firmware.algorithm_id);
  return kind != nullptr ? kind->make() : nullptr;
}

// Facts of kept records must follow from their samples.
Result<void> measure_kept(const fs::path& run, const RunMaterial& m, CheckAnswer& answer) {
  for (const PlayedRecord& one : m.records) {
    const CaseRecord& stored = one.record;
    if (stored.trace_file.empty()) continue;
    FORCEGATE_TRY(const TraceFile file, read_hdf5(run / stored.trace_file));
    const auto comparator = comparator_for(stored);
    CaseJob job = one.job;
    job.curves = !stored.overview.empty();
    FORCEGATE_TRY(const CaseRecord again, measure_again(job, stored, file.trace, comparator.get()));
    ++answer.measured_again;
    if (again.digest != stored.digest)
      answer.differences.push_back(
          fmt::format("{}: the kept samples are not those of the record", stored.id));
    else if (to_json(again) != to_json(stored))
      answer.differences.push_back(
          fmt::format("{}: this program measures something else in the same samples", stored.id));
  }
  return {};
}

using Made = std::vector<CaseRecord>;

Result<Made> play(const std::vector<CaseJob>& jobs, const CheckRequest& request, const GateProgress& progress, const std::atomic<bool>* cancelled) {
  WorkerOptions options;
  options.workers = request.threads;
  options.cancelled = cancelled;
  double done = 0.0;
  const WorkerEvents events{{}, [&](std::size_t job) {
                              done += 1.0;
                              if (progress) progress(done / static_cast<double>(jobs.size()), jobs[job].id);
                            }};
  Made made = run_in_workers(jobs, options, events);
  for (const CaseRecord& one : made)
    if (one.failure && one.failure->error.code == ErrorCode::cancelled) return fail(ErrorCode::cancelled, "interrupted");
  return made;
}

// Two plays of this program that differ from each other are the firmware's; two that agree with each other and not with the run are not.
SecondPlay of_each_other(const CaseRecord& one, const CaseRecord& other) { return one.failure ? compare_plays(other, one) : compare_plays(one, other); }

Result<void> play_again(const CheckRequest& request, RunMaterial& m, const GateProgress& progress,
                        const std::atomic<bool>* cancelled, CheckAnswer& answer) {
  if (!m.head.rig.emulated)
    return fail(ErrorCode::usage, "only records of the emulated rig can be played again",
                request.run.string(), "leave --replay out: what was measured is judged in any case");
  std::vector<CaseJob> jobs;
  std::vector<std::size_t> place;  // in the records
  for (std::size_t i = 0; i < m.records.size(); ++i) {
    if (m.records[i].record.failure || m.records[i].record.digest.empty()) continue;
    jobs.push_back(m.records[i].job);
    jobs.back().index = jobs.size() - 1;
    jobs.back().keep_path.clear();
    jobs.back().curves = false;
    jobs.back().image = fs::absolute(request.run / "bundle" / "firmware").string();
    place.push_back(i);
  }
  FORCEGATE_TRY(const Made made, play(jobs, request, progress, cancelled));
  answer.played_again = made.size();
  std::vector<CaseJob> once_more;
  std::vector<std::size_t> which;  // of those that were made
  for (std::size_t k = 0; k < made.size(); ++k) {
    if (!made[k].failure && made[k].digest == m.records[place[k]].record.digest) continue;
    once_more.push_back(jobs[k]);
    once_more.back().index = which.size();
    which.push_back(k);
  }
  if (which.empty()) return {};
  FORCEGATE_TRY(const Made second, play(once_more, request, {}, cancelled));
  for (std::size_t n = 0; n < which.size(); ++n) {
    const CaseRecord &one = made[which[n]], &stored = m.records[place[which[n]]].record;
    if (SecondPlay found = of_each_other(one, second[n]); found.is == SecondPlay::Is::other_by_firmware)
      answer.not_repeated.push_back(std::move(found.text));
    else if (one.failure)
      answer.differences.push_back(fmt::format("{}: cannot be played again: {}", stored.id, one.failure->error.to_text()));
    else
      answer.differences.push_back(fmt::format("{}: played again it gives other samples", stored.id));
  }
  const bool known = std::any_of(m.compared.begin(), m.compared.end(), [](const JudgedCheck& j) { return j.check.id == kRepeats; });
  if (auto check = repeats_check(answer.not_repeated); check && !known) m.compared.push_back(std::move(*check));
  return {};
}

// The other plan's records that the run does not have. A recording is one record of one case by its nature, and cases of a lane are for
// images that run there.
void ask_for_missing(const Plan& other, const fs::path& image, RunMaterial& m) {
  if (!m.head.rig.can_move) return;
  for (const PlanCase& c : other.cases) {
    const LaneKind* lane = c.lane.empty() ? nullptr : Registry<LaneKind>::instance().find(c.lane);
    if (lane != nullptr && !lane->accepts(image)) continue;
    for (const std::string& specimen : specimens_of(other, c)) {
      if (std::any_of(m.records.begin(), m.records.end(), [&](const PlayedRecord& one) {
            return m.plan.cases[one.case_index].name == c.name && one.job.specimen == specimen;
          }))
        continue;
      JudgedCheck j;
      j.judgeable = false;
      j.check.id = "record/" + c.name + "/" + specimen;
      j.check.title = "Record";
      j.check.value = std::nan("");
      j.check.blame = Blame::user;
      j.check.evidence = fmt::format("the run has no {} of {}, which the plan {} asks for: play it with forcegate gate", c.name, specimen, other.name);
      m.compared.push_back(std::move(j));
    }
  }
}

// Rule, limits and checks of another plan for the cases that were played.
Result<void> take_plan(const fs::path& path, const CheckRequest& request, RunMaterial& m) {
  FORCEGATE_TRY(Plan other, read_plan(path));
  for (PlanCase& c : m.plan.cases) {
    const auto at = std::find_if(other.cases.begin(), other.cases.end(),
                                 [&](const PlanCase& o) { return o.name == c.name; });
    if (at == other.cases.end())
      return fail(ErrorCode::usage, "the plan has no case '" + c.name + "', which the run has",
                  path.string(), "give a plan that has the run's cases, with other limits or another rule");
    if (m.head.rig.can_move && (c.loop != at->loop || stimulus_in_words(c.stimulus) != stimulus_in_words(at->stimulus)))
      return fail(ErrorCode::usage, fmt::format("the case '{}' of the plan is another profile than the run played: {} {}, not {} {}", c.name, to_string(at->loop),
                                                stimulus_in_words(at->stimulus), to_string(c.loop), stimulus_in_words(c.stimulus)),
                  path.string(), "gate the image under this plan");
    c.checks = at->checks;
    c.tail_s = at->tail_s;
    c.maxima_pct = at->maxima_pct;
    c.minima_pct = at->minima_pct;
    c.limit_source = at->limit_source;
  }
  m.plan.rule = other.rule;
  m.plan.limits = other.limits;
  m.plan.uncertainty = other.uncertainty;
  m.plan.self_check = other.self_check;
  m.plan.name = m.head.plan_name = other.name;
  m.plan.sha256 = m.head.plan_sha256 = other.sha256;
  m.head.decision_rule = other.rule.to_text();
  for (JudgedCheck& j : m.compared)
    if (j.check.id.starts_with("no_worse_")) j.check.limit.value = other.limits.increase_pct;
  ask_for_missing(other, request.run / "bundle" / "firmware", m);
  m.limits = {};
  if (other.limits.derived.empty() || !request.limits.empty()) return {};
  FORCEGATE_TRY(m.limits, read_limits(path.parent_path() / other.limits.derived));
  return {};
}

// A run of cases on the test bench under what the request asks for.
Result<void> look_again(const CheckRequest& request, RunMaterial& m, const GateProgress& progress,
                        const std::atomic<bool>* cancelled, CheckAnswer& answer) {
  FORCEGATE_CHECK_OK(measure_kept(request.run, m, answer));
  if (request.replay) FORCEGATE_CHECK_OK(play_again(request, m, progress, cancelled, answer));
  if (!request.plan.empty()) {
    FORCEGATE_TRY(const fs::path plan, find_plan(request.plan.string()));
    FORCEGATE_CHECK_OK(take_plan(plan, request, m));
  }
  if (!request.limits.empty()) {
    FORCEGATE_TRY(m.limits, read_limits(request.limits));
  }
  return {};
}

// A run of a firmware that reads conductance and capacitance.
Result<void> look_again(const CheckRequest& request, WeightMaterial& m, const GateProgress& progress,
                        const std::atomic<bool>* cancelled, CheckAnswer& answer) {
  if (!request.limits.empty())
    return fail(ErrorCode::usage, "a gate of conductance and capacitance has no derived limits",
                request.limits.string(),
                "its limits stand in its plan: --plan judges under those of another");
  if (request.replay) {
    FORCEGATE_TRY(const auto digests, play_weights_again(m, request.run / "bundle" / "firmware", request.threads, progress, cancelled));
    for (std::size_t i = 0; i < digests.size(); ++i) {
      if (m.records[i].failure) continue;
      ++answer.played_again;
      const std::string& id = m.head.cases[i].id;
      if (!digests[i])
        answer.differences.push_back(fmt::format("{}: cannot be played again: {}", id, digests[i].error().to_text()));
      else if (*digests[i] != m.head.cases[i].digest)
        answer.differences.push_back(fmt::format("{}: played again it gives other samples", id));
    }
  }
  if (request.plan.empty()) return {};
  FORCEGATE_TRY(const fs::path path, find_plan(request.plan.string()));
  FORCEGATE_TRY(characterize::WeightGatePlan other, characterize::read_weight_gate_plan(path));
  if (other.loadings != m.plan.loadings || other.pack != m.plan.pack ||
      other.frame_samples() != m.plan.frame_samples() || other.study.seed != m.plan.study.seed)
    return fail(ErrorCode::usage, "the plan plays something else than the run did", path.string(),
                "give one that differs in its limits alone");
  other.goldens = m.plan.goldens;
  m.plan = std::move(other);
  m.head.plan_sha256 = m.plan.sha256;
  m.head.decision_rule = m.plan.rule.to_text();
  return {};
}

}  // namespace

Result<CheckAnswer> check_run(const CheckRequest& request, const GateProgress& progress,
                              const std::atomic<bool>* cancelled) {
  FORCEGATE_CHECK_OK(check_day(request.today));
  FORCEGATE_TRY(Bundle bundle, read_bundle(request.run));
  CheckAnswer answer;
  answer.bundle_id = bundle.id;
  if (!request.today.empty()) bundle.evidence.today = request.today;
  answer.other_limits = !request.plan.empty() || !request.limits.empty() || !request.today.empty();
  std::vector<std::string> notes;  // head.json has them already
  const Result<void> judged = std::visit(
      [&](auto& m) -> Result<void> {
        answer.records = m.records.size();
        FORCEGATE_CHECK_OK(look_again(request, m, progress, cancelled, answer));
        answer.result = judged_run(m, bundle.evidence, notes);
        return {};
      },
      bundle.material);
  if (!judged) return Unexpected(judged.error());
  const fs::path stored = request.run / "result.json";
  FORCEGATE_TRY(const RunResult before, read_result(stored));
  answer.stored = before.decision;
  FORCEGATE_TRY(const std::string bytes, read_file(stored));
  answer.same_bytes = bytes == to_json(answer.result);
  if (!answer.same_bytes && !answer.other_limits && answer.not_repeated.empty())
    answer.differences.push_back(
        bundle.tool_version == answer.result.tool_version
            ? "this program judges the same records otherwise than result.json says"
            : fmt::format("result.json was written by version {}", bundle.tool_version));
  return answer;
}

std::string check_text(const CheckAnswer& a) {
  std::string out = fmt::format("{}: {}\n", to_string(a.result.decision.kind), a.result.decision.reason);
  out += fmt::format("  bundle {}, {}, every file as the run wrote it\n", a.bundle_id.substr(0, 16),
                     counted(a.records, "record"));
  if (a.measured_again > 0)
    out += "  " + counted(a.measured_again, "record") + " measured again from " + (a.measured_again == 1 ? "its" : "their") + " samples\n";
  if (a.played_again > 0)
    out += "  " + counted(a.played_again, "record") + " played again by the emulated rig\n";
  if (a.other_limits)
    out += fmt::format("  under the limits of the run: {}: {}\n", to_string(a.stored.kind), a.stored.reason);
  else if (!a.same_bytes && !a.not_repeated.empty())
    out += fmt::format("  the run itself: {}: {}\n", to_string(a.stored.kind), a.stored.reason);
  else if (a.same_bytes)
    out += "  the result is the stored one, byte for byte\n";
  for (const std::string& n : a.not_repeated) out += "  NOT REPEATED: " + n + "\n";
  for (const std::string& d : a.differences) out += "  DIFFERENT: " + d + "\n";
  return out;
}

std::string check_json(const CheckAnswer& a) {
  const auto decision = [](const Decision& d) {
    return nlohmann::ordered_json{{"kind", to_string(d.kind)},
                                  {"blame", to_string(d.blame)},
                                  {"exit_code", d.exit_code},
                                  {"reason", d.reason}};
  };
  return nlohmann::ordered_json{{"format", 1},
                                {"bundle", a.bundle_id},
                                {"decision", decision(a.result.decision)},
                                {"stored", decision(a.stored)},
                                {"other_limits", a.other_limits},
                                {"same_bytes", a.same_bytes},
                                {"records", a.records},
                                {"measured_again", a.measured_again},
                                {"played_again", a.played_again},
                                {"not_repeated", a.not_repeated},
                                {"differences", a.differences}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
