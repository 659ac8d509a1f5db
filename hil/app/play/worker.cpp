#include "hil/app/play/worker.h"

#include <map>
#include <set>

#include "hil/app/play/case_recorder.h"
#include "hil/base/rng.h"
#include "hil/gate/board_faults.h"
#include "hil/gate/calibrate.h"
#include "hil/gate/case_json.h"
#include "hil/gate/runner.h"
#include "hil/interface/comparator.h"

namespace forcegate {
namespace {

CaseRecord failed(const CaseJob& job, CaseFailure::Stage stage, Error error) {
  CaseRecord record;
  record.id = job.id;
  record.index = job.index;
  record.failure = CaseFailure{stage, std::move(error)};
  return record;
}

// The lane is opened by the runner, which alone knows the rig's rate; the comparator is chosen by what the
// image then declares. This one waits for the declaration.
class LateComparator final : public Comparator {
 public:
  Result<void> begin(const ComparatorSession& session) override {
    const ComparatorKind* kind = comparator_of(session.algorithm_id);
    inner_ = kind != nullptr ? kind->make() : nullptr;
    if (inner_) return inner_->begin(session);
    return {};
  }
  void push(std::span<const std::uint16_t> adc, std::span<const float> force_N,
            std::span<const std::uint8_t> flags) override {
    if (inner_) inner_->push(adc, force_N, flags);
  }
  Comparison finish() override { return inner_ ? inner_->finish() : Comparison{}; }
  bool known() const { return inner_ != nullptr; }

 private:
  std::unique_ptr<Comparator> inner_;
};

}  // namespace

CaseRecord execute_job(const CaseJob& job, const std::function<void(double)>& progress,
                       const std::atomic<bool>* cancelled) {
  auto rig = make_rig(job.rig, job.rig_options);
  if (!rig) return failed(job, CaseFailure::Stage::rig, rig.error());
  if (job.kind == CaseJob::Kind::calibration) return run_calibration(job, **rig, cancelled);

  std::unique_ptr<Dut> own_dut;
  Dut* dut = (*rig)->board_lane() == job.lane ? (*rig)->board_firmware() : nullptr;
  if (dut == nullptr) {
    const LaneKind* lane = Registry<LaneKind>::instance().find(job.lane);
    if (lane == nullptr)
      return failed(job, CaseFailure::Stage::setup,
                    {ErrorCode::usage, "there is no lane named '" + job.lane + "'", {}, {}});
    auto made = lane->make(job.lane_options);
    if (!made) return failed(job, CaseFailure::Stage::setup, made.error());
    own_dut = with_board_faults(std::move(*made), job.faults, mix_seed(job.seed, job.id));
    dut = own_dut.get();
  }

  LateComparator comparator;
  CaseRecorder recorder(job.keep_path);
  RunDevices devices;
  devices.rig = rig->get();
  devices.dut = dut;
  devices.comparator = job.planned.checks & kCheckConformance ? &comparator : nullptr;
  devices.writer = job.keep_path.empty() ? nullptr : &recorder;
  devices.progress = progress;
  devices.cancelled = cancelled;
  CaseRecord record = run_case(job, devices);
  if (!job.keep_path.empty() && !record.failure)
    record.trace_file = "traces/" + std::filesystem::path(job.keep_path).filename().string();
  record.conformance_known = record.conformance_known && comparator.known();
  return record;
}

Result<std::string> execute_job_text(std::string_view job_json) {
  FORCEGATE_TRY(const CaseJob job, job_from_json(job_json));
  return to_json(execute_job(job));
}

std::vector<CaseRecord> run_in_workers(const std::vector<CaseJob>& jobs, const WorkerOptions& options,
                                       const WorkerEvents& events) {
  std::vector<WatchedTask> tasks;
  for (const CaseJob& job : jobs)
    tasks.push_back({job.id, [&job](const std::function<void(double)>& progress) -> Result<std::string> {
                       return to_json(execute_job(job, progress));
                     }, job.image});
  std::map<std::size_t, DutInfo> said;  // who crashed, as far as it told
  WorkerEvents all = events;
  all.died = [&](std::size_t task, const FirmwareGuard& guard) {
    said[task].board = guard.board;
    said[task].build_id = guard.build_id;
    said[task].algorithm_id = guard.algorithm_id;
    said[task].protocol_major = guard.protocol_major, said[task].protocol_minor = guard.protocol_minor;
    said[task].adc_bits = guard.adc_bits, said[task].rate_Hz = guard.rate_Hz;
  };
  std::set<std::size_t> given_up;
  all.given_up = [&](std::size_t task) { given_up.insert(task); };
  const auto answers = run_watched(tasks, options, all);
  std::vector<CaseRecord> records;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    auto record = answers[i] ? record_from_json(*answers[i]) : Unexpected(answers[i].error());
    if (record) {
      records.push_back(std::move(*record));
      continue;
    }
    const ErrorCode code = answers[i] ? ErrorCode::internal : record.error().code;
    records.push_back(failed(jobs[i],
                             given_up.contains(i)           ? CaseFailure::Stage::setup
                             : code == ErrorCode::firmware  ? CaseFailure::Stage::firmware
                             : code == ErrorCode::cancelled ? CaseFailure::Stage::setup
                                                            : CaseFailure::Stage::harness,
                             {code, record.error().text, jobs[i].id, {}}));
    if (const auto who = said.find(i); who != said.end()) records.back().firmware = who->second;
  }
  return records;
}

}  // namespace forcegate
