#include "hil/app/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/app/gate_jobs.h"
#include "hil/app/run_folder.h"
#include "hil/app/worker.h"
#include "hil/base/text.h"
#include "hil/gate/calibrate.h"
#include "hil/gate/case_result.h"
#include "hil/gate/decision.h"
#include "hil/gate/judge.h"

namespace forcegate {
namespace {

// Progress over all jobs by rig time.
class Meter {
 public:
  Meter(const GateProgress& sink, double total_s) : sink_(sink), total_s_(std::max(1.0, total_s)) {}
  void begin(const std::vector<CaseJob>& jobs) {
    at_s_.assign(jobs.size(), 0.0);
    length_s_.clear();
    for (const CaseJob& job : jobs) length_s_.push_back(rig_time_s(job));
    jobs_ = &jobs;
  }
  void progress(std::size_t job, double t_s) { report(job, std::min(t_s, length_s_[job])); }
  void done(std::size_t job) { report(job, length_s_[job]); }

 private:
  void report(std::size_t job, double t_s) {
    done_s_ += t_s - at_s_[job];
    at_s_[job] = t_s;
    if (sink_) sink_(std::clamp(done_s_ / total_s_, 0.0, 1.0), (*jobs_)[job].id);
  }
  const GateProgress& sink_;
  double total_s_, done_s_ = 0.0;
  std::vector<double> at_s_, length_s_;
  const std::vector<CaseJob>* jobs_ = nullptr;
};

class GateRun {
 public:
  GateRun(const GateRequest& request, GateSetup setup, const std::atomic<bool>* cancelled)
      : request_(request), setup_(std::move(setup)), cancelled_(cancelled) {}

  Result<RunResult> run(const GateProgress& progress) {
    FORCEGATE_CHECK_OK(read_derived_limits());
    std::optional<RunFolder> folder;
    if (!request_.output.empty()) {
      FORCEGATE_TRY(RunFolder opened, RunFolder::open(request_.output));
      folder.emplace(std::move(opened));
    }
    head();
    calibration_jobs_ = calibration_jobs(request_, setup_);
    double total_s = 0.0;
    for (const CaseJob& job : calibration_jobs_) total_s += rig_time_s(job);
    for (const PlanCase& c : setup_.plan.cases) {
      CaseJob job;
      job.planned = c;
      total_s += rig_time_s(job) * static_cast<double>(specimens_of(setup_.plan, c).size());
    }
    Meter meter(progress, total_s);
    FORCEGATE_CHECK_OK(calibrate(meter));
    jobs_ = record_jobs(request_, setup_, calibrations_);
    play(meter, folder ? folder->path() : std::filesystem::path());
    FORCEGATE_CHECK_OK(first_usage_error());
    judge();
    if (folder && !is_cancelled()) FORCEGATE_CHECK_OK(folder->publish(result_));
    return std::move(result_);
  }

 private:
  bool is_cancelled() const { return cancelled_ != nullptr && cancelled_->load(); }

  Result<void> read_derived_limits() {
    const Plan& plan = setup_.plan;
    if (plan.limits.derived.empty()) return {};
    const std::filesystem::path path = plan.path.parent_path() / plan.limits.derived;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      result_.notes.push_back("there is no limits file " + plan.limits.derived +
                              ": derive it with forcegate limits");
      return {};
    }
    FORCEGATE_TRY(limits_, read_limits(path));
    return {};
  }

  void head() {
    const Plan& plan = setup_.plan;
    result_.tool_version = FORCEGATE_VERSION;
    result_.command_line = request_.command_line;
    result_.started_at = request_.started_at;
    result_.plan_name = plan.name;
    result_.plan_sha256 = plan.sha256;
    result_.seed = plan.seed;
    result_.firmware_path = request_.firmware.string();
    result_.firmware_sha256 = setup_.firmware_sha256;
    result_.rig = setup_.rig;
    result_.decision_rule = plan.rule.to_text();
    result_.environment["compiler"] = "GCC " __VERSION__;
    result_.environment["lane"] = setup_.lane;
  }

  WorkerOptions worker_options() const {
    WorkerOptions options;
    options.workers = request_.threads;
    options.cancelled = cancelled_;
    return options;
  }

  static WorkerEvents events(Meter& meter) {
    return {[&meter](std::size_t job, double t_s) { meter.progress(job, t_s); },
            [&meter](std::size_t job) { meter.done(job); }};
  }

  Result<void> calibrate(Meter& meter) {
    Calibration base = nominal_calibration(setup_.rig);
    level_ = setup_.plan.calibration.level;
    if (!request_.calibration_file.empty()) {
      FORCEGATE_TRY(base, read_calibration_file(request_.calibration_file, setup_.rig));
      level_ = base.level;
      result_.notes.push_back(
          fmt::format("calibration '{}' from {}", base.id, request_.calibration_file.string()));
    } else if (!setup_.rig.can_move) {
      level_ = CalibrationLevel::nominal;
      result_.notes.push_back(
          "no calibration was given: the nominal values of the sensor type are used (--cal FILE)");
    }
    calibrations_.assign(setup_.specimens.size(), base);
    meter.begin(calibration_jobs_);
    calibration_records_ = run_in_workers(calibration_jobs_, worker_options(), events(meter));
    for (std::size_t i = 0; i < calibration_records_.size(); ++i) {
      const CaseRecord& r = calibration_records_[i];
      if (!r.failure) calibrations_[i] = r.calibration;
      if (!r.calibration_text.empty()) result_.notes.push_back("calibration of " + r.calibration_text);
    }
    result_.notes.push_back(fmt::format("calibration level: {}", to_string(level_)));
    return {};
  }

  const CaseRecord* calibration_failure(const std::string& specimen) const {
    for (const CaseRecord& r : calibration_records_)
      if (r.failure && r.id == "calibration/" + specimen) return &r;
    return nullptr;
  }

  void play(Meter& meter, const std::filesystem::path& folder) {
    // A record on a specimen without calibration would blame the firmware for it.
    std::vector<CaseJob> runnable;
    std::vector<std::size_t> place;
    records_.resize(jobs_.size());
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (const CaseRecord* bad = calibration_failure(jobs_[i].specimen)) {
        records_[i].id = jobs_[i].id;
        records_[i].index = i;
        records_[i].failure = bad->failure;
        records_[i].failure->error.text =
            "calibration of " + jobs_[i].specimen + ": " + bad->failure->error.text;
        continue;
      }
      if (request_.keep && !folder.empty()) jobs_[i].keep_path = trace_path(folder, jobs_[i]).string();
      if (!setup_.rig.emulated) jobs_[i].curves = true;  // it cannot be played again
      runnable.push_back(jobs_[i]);
      place.push_back(i);
    }
    meter.begin(runnable);
    auto made = run_in_workers(runnable, worker_options(), events(meter));
    for (std::size_t k = 0; k < made.size(); ++k) records_[place[k]] = std::move(made[k]);
    judge_records();
    if (folder.empty() || request_.keep || is_cancelled()) return;
    keep_doubtful(folder);
  }

  static std::filesystem::path trace_path(const std::filesystem::path& folder, const CaseJob& job) {
    std::string name = job.id;
    std::replace(name.begin(), name.end(), '/', '@');
    return folder / "traces" / (name + ".h5");
  }

  // Emulated records are recipes: those in doubt are played again with a recorder.
  void keep_doubtful(const std::filesystem::path& folder) {
    if (!setup_.rig.emulated) return;
    std::vector<CaseJob> again;
    std::vector<std::size_t> place;
    for (std::size_t i = 0; i < jobs_.size() && again.size() < kMostKept; ++i) {
      const bool doubt =
          std::any_of(judged_[i].checks.begin(), judged_[i].checks.end(), [](const JudgedCheck& j) {
            return j.check.required && j.check.verdict != Verdict::pass &&
                   j.check.verdict != Verdict::not_run;
          });
      if (!doubt || records_[i].failure) continue;
      again.push_back(jobs_[i]);
      again.back().keep_path = trace_path(folder, jobs_[i]).string();
      again.back().curves = true;
      place.push_back(i);
    }
    auto made = run_in_workers(again, worker_options());
    for (std::size_t k = 0; k < made.size(); ++k)
      if (!made[k].failure && made[k].digest == records_[place[k]].digest)
        records_[place[k]] = std::move(made[k]);
  }

  // Verdicts of single records; the decision rule runs over all of them together.
  void judge_records() {
    judged_.clear();
    std::size_t i = 0;
    for (const PlanCase& planned : setup_.plan.cases)
      for (std::size_t k = 0; k < specimens_of(setup_.plan, planned).size(); ++k, ++i)
        judged_.push_back(judge_case(setup_.plan, planned, records_[i], limits_));
    panel_.clear();
    i = 0;
    for (const PlanCase& planned : setup_.plan.cases) {
      const auto& specimens = specimens_of(setup_.plan, planned);
      std::vector<const JudgedCase*> group;
      for (std::size_t k = 0; k < specimens.size(); ++k) group.push_back(&judged_[i++]);
      for (JudgedCheck& check : judge_panel(setup_.plan, planned, specimens, group))
        panel_.push_back(std::move(check));
    }
    std::vector<JudgedCheck*> all;
    for (JudgedCheck& check : panel_) all.push_back(&check);
    for (JudgedCase& one : judged_)
      for (JudgedCheck& check : one.checks) all.push_back(&check);
    apply_rule(setup_.plan.rule, all);
  }

  void judge() {
    RunEvents events;
    events.level = level_;
    events.cancelled = is_cancelled();
    std::vector<const Check*> all;
    for (const JudgedCheck& check : panel_) all.push_back(&check.check);
    for (const JudgedCase& one : judged_) {
      for (const JudgedCheck& check : one.checks) all.push_back(&check.check);
      events.cancelled = events.cancelled || one.cancelled;
      if (one.harness_error && !events.harness_error) {
        events.harness_error = true;
        events.harness_text = one.harness_text;
      }
      if (one.safety_stop) {
        if (!events.safety_stop || !one.safety_cause_decided) events.safety_text = one.safety_text;
        events.safety_stop = true;
        events.safety_cause_decided = events.safety_cause_decided && one.safety_cause_decided;
      }
    }
    result_.decision = decide(all, setup_.plan.rule, events);
    for (const CaseRecord& r : records_)
      if (!r.firmware.algorithm_id.empty()) {
        result_.firmware = r.firmware;
        result_.rig = r.rig;
        break;
      }
    for (const JudgedCheck& check : panel_) result_.checks.push_back(check.check);
    std::size_t i = 0;
    for (const PlanCase& planned : setup_.plan.cases) {
      const auto& specimens = specimens_of(setup_.plan, planned);
      for (std::size_t k = 0; k < specimens.size(); ++k, ++i) {
        const bool curves = jobs_[i].curves;
        result_.cases.push_back(
            to_case_result(planned, jobs_[i], std::move(records_[i]), judged_[i], curves));
      }
    }
  }

  // A mistake in the request that only a record could show (a missing emulator, an instrument's option).
  Result<void> first_usage_error() const {
    for (const CaseRecord& r : records_) {
      if (!r.failure) continue;
      const ErrorCode code = r.failure->error.code;
      if (code == ErrorCode::usage || code == ErrorCode::config) return Unexpected(r.failure->error);
    }
    return {};
  }

  static constexpr std::size_t kMostKept = 20;
  const GateRequest& request_;
  GateSetup setup_;
  const std::atomic<bool>* cancelled_;
  DerivedLimits limits_;
  CalibrationLevel level_ = CalibrationLevel::nominal;
  std::vector<CaseJob> calibration_jobs_, jobs_;
  std::vector<CaseRecord> calibration_records_, records_;
  std::vector<Calibration> calibrations_;
  std::vector<JudgedCase> judged_;
  std::vector<JudgedCheck> panel_;
  RunResult result_;
};

}  // namespace

Result<RunResult> gate(const GateRequest& request, const GateProgress& progress,
                       const std::atomic<bool>* cancelled) {
  FORCEGATE_TRY(GateSetup setup, prepare_gate(request));
  return GateRun(request, std::move(setup), cancelled).run(progress);
}

}  // namespace forcegate
