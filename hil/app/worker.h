#pragma once
// Records are made in worker processes, one each: two firmware instances in one process would share static
// state, and a firmware that crashes or hangs must not end the run.

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/gate/case_record.h"

namespace forcegate {

/// Makes the record of a job in this process. Never fails: see CaseRecord::failure.
CaseRecord execute_job(const CaseJob& job, const std::function<void(double t_s)>& progress = {},
                       const std::atomic<bool>* cancelled = nullptr);

/// `forcegate worker`: one job as JSON in, its record as JSON out. For debuggers and for running one record
/// by hand.
Result<std::string> execute_job_text(std::string_view job_json);

struct WorkerOptions {
  unsigned workers = 0;      ///< at a time; 0: one per processor
  double hang_cpu_s = 10.0;  ///< CPU time without progress inside the firmware that counts as a hang
  double blocked_s = 120.0;  ///< wall time without progress and without CPU time
  const std::atomic<bool>* cancelled = nullptr;
};

/// What a caller may show while jobs run. Called from the calling thread.
struct WorkerEvents {
  std::function<void(std::size_t job, double t_s)> progress;
  std::function<void(std::size_t job)> done;
};

/// Runs every job in a forked child of its own and returns the records in the order of the jobs, whatever the
/// number of workers. A child that dies or hangs gives a record whose failure names signal and sample: stage
/// firmware when the firmware was running, else harness. The calling process must have no other threads.
std::vector<CaseRecord> run_in_workers(const std::vector<CaseJob>& jobs, const WorkerOptions& options,
                                       const WorkerEvents& events = {});

}  // namespace forcegate
