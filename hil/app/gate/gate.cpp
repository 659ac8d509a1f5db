#include "hil/app/gate/gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/app/gate/bundle.h"
#include "hil/app/gate/gate_player.h"
#include "hil/app/gate/plan_remarks.h"
#include "hil/app/gate/repeats.h"
#include "hil/app/gate/run_folder.h"
#include "hil/app/gate/same_conditions.h"
#include "hil/base/text.h"
#include "hil/gate/run_judge.h"

namespace forcegate {
namespace {

class GateRun {
 public:
  GateRun(const GateRequest& request, GateSetup setup, const std::atomic<bool>* cancelled)
      : request_(request), setup_(std::move(setup)), cancelled_(cancelled) {}

  Result<RunResult> run(const GateProgress& progress) {
    head();
    FORCEGATE_CHECK_OK(read_derived_limits());
    if (!request_.accepted.empty()) {
      FORCEGATE_TRY(accepted_, open_accepted(request_, &setup_, result_));
    }
    FORCEGATE_TRY(evidence_, read_evidence(request_, setup_.plan.path, setup_.plan.limits.goldens));
    std::optional<RunFolder> folder;
    if (!request_.output.empty()) {
      FORCEGATE_TRY(RunFolder opened, RunFolder::open(request_.output, read_while_it_runs()));
      folder.emplace(std::move(opened));
      keeps_all_ = request_.keep || plays_only_once(request_, setup_);
      if (plays_only_once(request_, setup_)) folder->keep_traces();
      for (const std::filesystem::path& left : folder->left_by_others())
        result_.notes.push_back("what a run that died had recorded is kept: " + left.string());
      if (folder->older_stays()) older_note_ = "the older run of that name, which a bench has played, is kept: " + folder->older().string();
      if (!older_note_.empty()) result_.notes.push_back(older_note_);
    }
    const std::filesystem::path keep_folder = folder ? folder->path() : std::filesystem::path();
    if (accepted_) result_.notes.push_back(accepted_note(*accepted_));
    GatePlayer player(request_, setup_, limits_, progress, cancelled_);
    player_ = &player;
    if (accepted_) player.set_accepted(&*accepted_);
    player.take_base_calibration();
    keeps_doubtful_ = folder && !keeps_all_;
    look(keep_folder);
    FORCEGATE_CHECK_OK(first_usage_error());
    player.expect_more(false);
    if (keeps_doubtful_ && !player.cancelled()) keep_doubtful(keep_folder);
    if (progress && !player.cancelled()) progress(1.0, "what the records say");
    return conclude(folder);
  }

 private:
  std::vector<std::filesystem::path> read_while_it_runs() const {
    std::vector<std::filesystem::path> out{request_.firmware, setup_.plan.path, limits_path_, request_.waivers};
    if (accepted_ && !accepted_->stored) out.push_back(accepted_->path);
    if (const auto record = request_.rig_options.find("record"); record != request_.rig_options.end()) out.push_back(record->second);
    return out;
  }

  Result<void> read_derived_limits() {
    const Plan& plan = setup_.plan;
    if (!request_.limits_file.empty()) {
      FORCEGATE_TRY(limits_, read_limits(request_.limits_file));
      limits_path_ = request_.limits_file;
      result_.notes.push_back(fmt::format("limits from {}", request_.limits_file.string()));
      note_another_rig();
      return {};
    }
    if (plan.limits.derived.empty()) return {};
    const std::filesystem::path path = plan.path.parent_path() / plan.limits.derived;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
      if (!request_.makes_limits && lacks_limits(plan))
        return fail(ErrorCode::config, "there is no limits file " + printable_utf8(path.lexically_normal().string()) + ", and nothing else says how far off a case may be",
                    plan.limits.derived_where, no_limits_file_help(plan));
      result_.notes.push_back("there is no limits file " + plan.limits.derived +
                              ": derive it with forcegate limits");
      return {};
    }
    FORCEGATE_TRY(limits_, read_limits(path));
    limits_path_ = path;
    note_another_rig();
    return {};
  }

  void note_another_rig() {
    if (!limits_.by_case_and_check.empty() && !limits_.of_rig(setup_.rig))
      result_.notes.push_back(fmt::format("the limits were derived on the rig {}, this one is {}/{}: the systematic uncertainty counts in full against them", printable_utf8(limits_.rig),
                                          setup_.rig.name, setup_.rig.version));
  }

  void head() {
    const Plan& plan = setup_.plan;
    result_ = run_head(request_, setup_.firmware_sha256, setup_.lane);
    result_.plan_name = plan.name;
    result_.plan_sha256 = plan.sha256;
    result_.seed = plan.seed;
    result_.rig = setup_.rig;
    result_.decision_rule = plan.rule.to_text();
    state_conditions(request_, result_);
    for (const std::string& note : setup_.notes) result_.notes.push_back(note);
  }

  using Wanted = std::vector<std::pair<std::size_t, std::size_t>>;

  // First every record once; then more sessions of what is undecided only for want of evidence.
  void look(const std::filesystem::path& keep_folder) {
    Wanted wanted;
    for (std::size_t k = 0; k < setup_.plan.cases.size(); ++k)
      for (std::size_t i = 0; i < specimens_of(setup_.plan, setup_.plan.cases[k]).size(); ++i)
        wanted.emplace_back(k, i);
    const int looks = setup_.rig.can_move && !request_.single_look ? setup_.plan.rule.looks : 1;
    for (int n = 1; !wanted.empty() && !player_->cancelled(); ++n) {
      player_->expect_more(n < looks || keeps_doubtful_);
      player_->play(static_cast<std::uint64_t>(n - 1), wanted, keep_folder);
      judge();
      wanted = n < looks ? undecided(n) : Wanted();
    }
  }

  void judge() {
    panel_ = judge_records(setup_.plan, limits_, player_->records());
    compare();
  }

  // Both builds have read the same rows.
  bool is_one_recording() const {
    const auto digest = [](const RigInfo& rig) {
      const auto at = rig.details.find("record_sha256");
      return at == rig.details.end() ? std::string() : at->second;
    };
    if (setup_.rig.can_move) return false;
    return !accepted_->stored || (!digest(setup_.rig).empty() && digest(setup_.rig) == digest(accepted_->run.rig));
  }

  void compare() {
    if (!accepted_) return;
    std::vector<ComparedRecord> pairs;
    for (const PlayedRecord& one : player_->records())
      if (!one.superseded)
        pairs.push_back({&setup_.plan.cases[one.case_index], &one.record, player_->accepted(one.job),
                         &one.judged.checks});
    compared_ = compare_with_accepted(setup_.plan, limits_, *accepted_, setup_.rig.emulated || is_one_recording(), pairs);
    panel_.insert(panel_.end(), compared_.begin(), compared_.end());
    charge_compared(setup_.plan, player_->records(), panel_);
    std::vector<JudgedCheck*> all = all_checks(panel_, player_->records());
    apply_rule(setup_.plan.rule, all);
  }

  // Records that the next session needs: a panel's mean needs all its specimens.
  Wanted undecided(int looks_so_far) {
    Wanted wanted;
    std::vector<std::string> names;
    for (const JudgedCheck* open :
         worth_another_session(setup_.plan.rule, all_checks(panel_, player_->records())))
      for (std::size_t k = 0; k < setup_.plan.cases.size(); ++k) {
        const PlanCase& planned = setup_.plan.cases[k];
        const auto& specimens = specimens_of(setup_.plan, planned);
        for (std::size_t i = 0; i < specimens.size(); ++i) {
          const std::string record = planned.name + "/" + specimens[i];
          const Check& c = open->check;
          const bool one = c.case_id == record || c.id.ends_with("/" + record);
          const bool panel = c.case_id.empty() &&
                             (c.id.starts_with("promise_") || c.id.starts_with("no_worse_")) &&
                             c.id.ends_with("/" + planned.name);
          if ((one || panel) && std::find(wanted.begin(), wanted.end(), std::pair(k, i)) == wanted.end())
            wanted.emplace_back(k, i);
          if ((one || panel) && std::find(names.begin(), names.end(), planned.name) == names.end())
            names.push_back(planned.name);
        }
      }
    if (!wanted.empty())
      result_.notes.push_back(fmt::format(
          "look {} left {} undecided for its uncertainty alone: session {} of {} records is played, all "
          "sessions count",
          looks_so_far, join(names, ", "), looks_so_far + 1, wanted.size()));
    std::sort(wanted.begin(), wanted.end());
    return wanted;
  }

  // Emulated records are recipes: those in doubt are played again with a recorder, and one in any case. What does not come out the same
  // is no evidence for anything.
  void keep_doubtful(const std::filesystem::path& folder) {
    if (!setup_.rig.emulated) return;
    std::vector<PlayedRecord*> doubtful;
    for (PlayedRecord& one : player_->records()) {
      const auto& checks = one.judged.checks;
      const bool doubt = std::any_of(checks.begin(), checks.end(), [](const JudgedCheck& j) {
        return j.check.required && j.check.verdict != Verdict::pass && j.check.verdict != Verdict::not_run;
      });
      if (doubt && !one.record.failure && doubtful.size() < kMostKept) doubtful.push_back(&one);
    }
    if (doubtful.empty()) player_->try_one_again();
    else player_->keep(doubtful, folder);
    if (auto check = repeats_check(player_->not_repeated())) compared_.push_back(std::move(*check));
  }

  // Golden traces and waivers come in when every record is made.
  Result<RunResult> conclude(std::optional<RunFolder>& folder) {
    if (player_->cancelled() && folder)
      result_.notes.push_back((folder->older().empty() ? "interrupted: there is no " + request_.output.string()
                                                       : "interrupted: " + request_.output.string() + " is the older run") +
                              kept_of(*folder));
    if (player_->cancelled()) std::erase(result_.notes, older_note_);  // it has its name again
    RunMaterial material{setup_.plan,
                         limits_,
                         player_->level(),
                         player_->cancelled(),
                         std::move(player_->records()),
                         std::move(compared_),
                         std::move(result_)};
    const auto& notes = player_->notes();
    material.head.notes.insert(material.head.notes.end(), notes.begin(), notes.end());
    std::vector<GoldenMargins> margins;
    RunResult result = judged_run(material, evidence_, material.head.notes, &margins);
    if (!folder || material.cancelled) return result;
    auto published = publish_run(*folder, {setup_.plan.path, request_.firmware, limits_path_, request_.waivers, evidence_, request_.plan}, material, margins, result);
    if (!published) {  // who waited for the decision has it all the same, and the samples that there is room for
      folder->keep_traces();
      published.error().hint += kept_of(*folder);
      note_not_written(result, std::move(published.error()));
    }
    return result;
  }

  // What a person does with what a bench has played, where no result is written.
  static std::string kept_of(const RunFolder& folder) {
    std::string out;
    for (const std::filesystem::path& trace : folder.traces_that_stay())
      out += (out.empty() ? "; what was recorded is kept: " : ", ") + (trace.extension() == ".fgj" ? "forcegate recover " : std::string()) + file_quoted(trace.string());
    return out;
  }

  // A mistake in the request that only a record could show (a missing emulator, an instrument's option). Where other records were
  // played, it is judged with them instead: a calibration that runs out in the night takes no result from the records before it.
  Result<void> first_usage_error() const {
    const auto is_mistake = [](const PlayedRecord& one) {
      if (!one.record.failure) return false;
      const ErrorCode code = one.record.failure->error.code;
      return code == ErrorCode::usage || code == ErrorCode::config;
    };
    const std::vector<PlayedRecord>& records = player_->records();
    if (std::any_of(records.begin(), records.end(), [](const PlayedRecord& one) { return !one.record.failure; })) return {};
    const auto first = std::find_if(records.begin(), records.end(), is_mistake);
    if (first != records.end()) return Unexpected(first->record.failure->error);
    return {};
  }

  static constexpr std::size_t kMostKept = 20;
  const GateRequest& request_;
  GateSetup setup_;
  const std::atomic<bool>* cancelled_;
  DerivedLimits limits_;
  std::filesystem::path limits_path_;
  std::optional<AcceptedBuild> accepted_;
  RunEvidence evidence_;
  std::string older_note_;
  bool keeps_all_ = false;        ///< the samples of every record
  bool keeps_doubtful_ = false;   ///< records in doubt are played again at the end, for their samples
  GatePlayer* player_ = nullptr;  ///< while run() lasts
  std::vector<JudgedCheck> panel_, compared_;
  RunResult result_;
};

}  // namespace

Result<RunResult> gate(const GateRequest& asked, const GateProgress& progress,
                       const std::atomic<bool>* cancelled) {
  GateRequest request = asked;
  FORCEGATE_TRY(GateSetup setup, prepare_gate(request));
  return GateRun(request, std::move(setup), cancelled).run(progress);
}

}  // namespace forcegate
