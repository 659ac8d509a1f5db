#include "hil/app/gate/gate_player.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/app/gate/repeats.h"
#include "hil/gate/blame.h"
#include "hil/gate/calibrate.h"

namespace forcegate {
namespace {

std::filesystem::path trace_path(const std::filesystem::path& folder, const CaseJob& job) {
  std::string name = job.id;
  std::replace(name.begin(), name.end(), '/', '@');
  if (job.attempt > 1) name += fmt::format("@attempt{}", job.attempt);
  return folder / "traces" / (name + ".h5");
}

bool rig_at_fault(const JudgedCase& judged) {
  return std::any_of(judged.checks.begin(), judged.checks.end(), [](const JudgedCheck& j) {
    return j.check.required && j.check.verdict == Verdict::rig_error;
  });
}

// A part of the record that stands is the firmware's failure whatever the rig did later.
bool firmware_failed(const JudgedCase& judged) {
  return std::any_of(judged.checks.begin(), judged.checks.end(), [](const JudgedCheck& j) {
    return j.check.required && j.check.verdict == Verdict::fail;
  });
}

}  // namespace

GatePlayer::GatePlayer(const GateRequest& request, const GateSetup& setup, const DerivedLimits& limits,
                       const GateProgress& progress, const std::atomic<bool>* cancelled)
    : request_(request),
      setup_(setup),
      limits_(limits),
      progress_(progress),
      cancelled_(cancelled),
      attempts_(setup.rig.can_move ? setup.plan.retry.attempts : 1),
      base_(nominal_calibration(setup.rig)) {}

void GatePlayer::take_base_calibration() {
  level_ = setup_.plan.calibration.level;
  if (setup_.calibration) {
    base_ = *setup_.calibration;
    level_ = base_.level;
    notes_.push_back(fmt::format("calibration '{}' from {}", base_.id, request_.calibration_file.string()));
  } else if (!setup_.rig.can_move) {
    level_ = CalibrationLevel::nominal;
    notes_.push_back("no calibration was given: the nominal values of the sensor type are used (--cal FILE)");
  }
  notes_.push_back(fmt::format("calibration level: {}", to_string(level_)));
}

std::vector<CaseRecord> GatePlayer::run(const std::vector<CaseJob>& jobs) {
  std::vector<double> at_s(jobs.size(), 0.0), length_s;
  for (const CaseJob& job : jobs) length_s.push_back(rig_time_s(job));
  const auto report = [&](std::size_t job, double t_s) {
    const double more_s = t_s - at_s[job];
    // what is played again comes on top of the plan: the rest of the bar is for it, and the bar never goes back
    if (more_s > 0.0) share_ += (ceiling_ - share_) * std::min(1.0, more_s / std::max(more_s, planned_s_ - done_s_));
    done_s_ += more_s;
    at_s[job] = t_s;
    if (progress_) progress_(share_, jobs[job].id);
  };
  WorkerOptions options;
  options.workers = request_.threads;
  if (plays_on_one_bench(request_, setup_)) options.workers = 1;
  options.cancelled = cancelled_;
  options.hang_cpu_s = request_.hang_cpu_s;
  auto made = run_in_workers(jobs, options,
                             {[&](std::size_t job, double t_s) { report(job, std::min(t_s, length_s[job])); },
                              [&](std::size_t job) {
                                if (!cancelled()) report(job, length_s[job]);
                              }});
  const auto left_out = std::count_if(made.begin(), made.end(), [](const CaseRecord& r) {
    return r.failure && r.failure->stage == CaseFailure::Stage::setup && r.failure->error.code == ErrorCode::firmware;
  });
  if (left_out > 0) notes_.push_back(fmt::format("the firmware did not come back from a record: {} others were not played", left_out));
  return made;
}

// Candidate and accepted build one after the other, every second pair the other way round: a drift of the rig hits both
// alike.
std::vector<CaseRecord> GatePlayer::run_in_turn(const std::vector<CaseJob>& jobs) {
  if (accepted_build_ == nullptr || accepted_build_->stored) return run(jobs);
  std::vector<CaseJob> both;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    both.push_back(jobs[i]);
    both.insert(i % 2 == 0 ? both.end() : both.end() - 1, accepted_job(jobs[i], *accepted_build_));
    planned_s_ += rig_time_s(jobs[i]);
  }
  for (std::size_t i = 0; i < both.size(); ++i) both[i].index = i;
  auto made = run(both);
  std::vector<CaseRecord> own;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::size_t candidate = 2 * i + i % 2;
    accepted_[jobs[i].id] = std::move(made[2 * i + 1 - i % 2]);
    made[candidate].index = i;
    own.push_back(std::move(made[candidate]));
  }
  return own;
}

const CaseRecord* GatePlayer::accepted(const CaseJob& job) const {
  const auto at = accepted_.find(job.id);
  return at == accepted_.end() ? nullptr : &at->second;
}

void GatePlayer::calibrate(std::uint64_t session, const std::vector<std::string>& specimens) {
  std::vector<std::string> open;
  CalibrationCache* cache = request_.calibrations;
  for (const std::string& specimen : specimens) {
    if (cache != nullptr && cache->known.contains({specimen, session}))
      calibrations_[{specimen, session}] = cache->known[{specimen, session}];
    if (!calibrations_.contains({specimen, session})) open.push_back(specimen);
  }
  for (int attempt = 1; attempt <= attempts_ && !open.empty(); ++attempt) {
    std::vector<CaseJob> jobs;
    for (const std::string& specimen : open) {
      jobs.push_back(calibration_job(request_, setup_, specimen, session, attempt));
      jobs.back().index = jobs.size() - 1;
    }
    if (attempt > 1)
      for (const CaseJob& job : jobs) planned_s_ += rig_time_s(job);
    const std::vector<CaseRecord> made = run(jobs);
    std::vector<std::string> again;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const Key key{open[i], session};
      const CaseRecord& r = made[i];
      calibrations_[key] = r.failure ? base_ : r.calibration;
      failures_.erase(key);
      if (cache != nullptr && !r.failure) cache->known[key] = r.calibration;
      if (r.failure) {
        failures_[key] = *r.failure;
        if (r.failure->stage == CaseFailure::Stage::rig && attempt < attempts_) {
          again.push_back(open[i]);
          notes_.push_back(
              fmt::format("{}, attempt {}: {}; made again", r.id, attempt, r.failure->error.text));
        }
      }
      if (!r.calibration_text.empty())
        notes_.push_back(
            (session == 0 ? "calibration of " : fmt::format("session {}, calibration of ", session + 1)) +
            r.calibration_text);
    }
    open = std::move(again);
  }
}

void GatePlayer::charge_silence(PlayedRecord& one) const {
  for (const PlayedRecord& before : records_) {
    if (before.job.id != one.job.id || before.job.attempt + 1 != one.job.attempt || !silent_at_the_same_sample(before.record, one.record)) continue;
    Error& error = one.record.failure->error;
    error.code = ErrorCode::firmware;
    error.text += "; so it was when the record was played before: what stops at one sample is the firmware";
    return;
  }
}

// Into the list to be played, or straight into the records when there is nothing to judge a firmware by.
void GatePlayer::add(PlayedRecord played, const std::filesystem::path& keep_folder,
                     std::vector<PlayedRecord>& to_play) {
  CaseJob& job = played.job;
  if (const auto bad = failures_.find({job.specimen, job.session}); bad != failures_.end()) {
    played.record.id = job.id;
    played.record.failure = bad->second;
    // While it is calibrated the board need not run what is judged.
    if (played.record.failure->error.code == ErrorCode::firmware) played.record.failure->error.code = ErrorCode::device;
    played.record.failure->error.text =
        "calibration of " + job.specimen + ": " + played.record.failure->error.text;
    const PlanCase& planned = setup_.plan.cases[played.case_index];
    played.judged = judge_case(setup_.plan, planned, played.record, limits_);
    records_.push_back(std::move(played));
    return;
  }
  if ((request_.keep || plays_only_once(request_, setup_)) && !keep_folder.empty()) job.keep_path = trace_path(keep_folder, job).string();
  job.index = to_play.size();
  to_play.push_back(std::move(played));
}

void GatePlayer::play(std::uint64_t session, const std::vector<std::pair<std::size_t, std::size_t>>& wanted,
                      const std::filesystem::path& keep_folder) {
  const auto specimen_of = [&](const std::pair<std::size_t, std::size_t>& at) -> const std::string& {
    return specimens_of(setup_.plan, setup_.plan.cases[at.first])[at.second];
  };
  std::vector<std::string> specimens;
  for (const auto& at : wanted)
    if (std::find(specimens.begin(), specimens.end(), specimen_of(at)) == specimens.end())
      specimens.push_back(specimen_of(at));
  const auto planned = [&](const auto& at) {
    PlayedRecord one;
    one.case_index = at.first;
    one.specimen_index = at.second;
    const auto known = calibrations_.find({specimen_of(at), session});
    one.job = record_job(request_, setup_, at.first, specimen_of(at), session, 1,
                         known != calibrations_.end() ? known->second : base_);
    return one;
  };
  for (const auto& at : wanted) planned_s_ += rig_time_s(planned(at).job);
  if (calibrates(request_, setup_)) {
    for (const std::string& specimen : specimens)
      if (!calibrations_.contains({specimen, session}))
        planned_s_ += rig_time_s(calibration_job(request_, setup_, specimen, session, 1));
    calibrate(session, specimens);
  }
  std::vector<PlayedRecord> list;
  for (const auto& at : wanted) add(planned(at), keep_folder, list);
  for (int attempt = 1; !list.empty(); ++attempt) {
    std::vector<CaseJob> jobs;
    for (const PlayedRecord& one : list) jobs.push_back(one.job);
    auto made = run_in_turn(jobs);
    std::vector<PlayedRecord> again;
    for (std::size_t i = 0; i < made.size(); ++i) {
      PlayedRecord& one = list[i];
      one.record = std::move(made[i]);
      charge_silence(one);
      one.judged = judge_case(setup_.plan, setup_.plan.cases[one.case_index], one.record, limits_);
      one.superseded =
          attempt < attempts_ && !cancelled() && rig_at_fault(one.judged) && !firmware_failed(one.judged);
      if (one.superseded) {
        PlayedRecord next;
        next.case_index = one.case_index;
        next.specimen_index = one.specimen_index;
        next.job = record_job(request_, setup_, one.case_index, one.job.specimen, session, attempt + 1,
                              one.job.calibration);
        planned_s_ += rig_time_s(next.job);
        notes_.push_back(
            fmt::format("{}, attempt {}: the rig was at fault; played again", one.job.id, attempt));
        add(std::move(next), keep_folder, again);
      }
      records_.push_back(std::move(one));
    }
    list = std::move(again);
  }
}

void GatePlayer::keep(const std::vector<PlayedRecord*>& doubtful, const std::filesystem::path& folder) {
  std::vector<CaseJob> jobs;
  for (const PlayedRecord* one : doubtful) {
    jobs.push_back(one->job);
    jobs.back().index = jobs.size() - 1;
    jobs.back().keep_path = trace_path(folder, one->job).string();
    jobs.back().curves = true;
    planned_s_ += rig_time_s(jobs.back());
  }
  auto made = run(jobs);
  for (std::size_t k = 0; k < made.size(); ++k) {
    if (!note_second_play(doubtful[k]->record, made[k])) {
      std::error_code ignored;  // of another play than the one that is judged: it belongs to no record
      for (const char* ending : {".h5", ".fgj"}) std::filesystem::remove(std::filesystem::path(jobs[k].keep_path).replace_extension(ending), ignored);
      continue;
    }
    doubtful[k]->job.curves = true;
    doubtful[k]->record = std::move(made[k]);
  }
}

void GatePlayer::try_one_again() {
  if (setup_.rig.name != "emulated") return;  // of another rig a difference says nothing of the firmware
  const PlayedRecord* shortest = nullptr;
  for (const PlayedRecord& one : records_)
    if (!one.superseded && !one.record.failure && (shortest == nullptr || one.record.duration_s < shortest->record.duration_s)) shortest = &one;
  if (shortest == nullptr) return;
  CaseJob job = shortest->job;
  job.index = 0;
  job.keep_path.clear();
  job.curves = false;
  planned_s_ += rig_time_s(job);
  const auto made = run({job});
  note_second_play(shortest->record, made.front());
}

bool GatePlayer::note_second_play(const CaseRecord& first, const CaseRecord& again) {
  SecondPlay second = compare_plays(first, again);
  if (second.is == SecondPlay::Is::other_by_firmware) not_repeated_.push_back(std::move(second.text));
  else if (second.is == SecondPlay::Is::other) notes_.push_back("a second play is not the first one, and is not kept: " + second.text);
  return second.is == SecondPlay::Is::same;
}

}  // namespace forcegate
