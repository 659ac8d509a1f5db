#pragma once
// Records of a gate run, each made in a worker process of its own (watched_task.h).

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/play/watched_task.h"
#include "hil/gate/case_record.h"

namespace forcegate {

/// Makes the record of a job in this process. Never fails: see CaseRecord::failure.
CaseRecord execute_job(const CaseJob& job, const std::function<void(double t_s)>& progress = {},
                       const std::atomic<bool>* cancelled = nullptr);

/// `forcegate worker`: one job as JSON in, its record as JSON out. For debuggers and for running one record
/// by hand.
Result<std::string> execute_job_text(std::string_view job_json);

/// Runs every job in a forked child of its own and returns the records in the order of the jobs, whatever the
/// number of workers. A child that dies or hangs gives a record whose failure names signal and sample: stage
/// firmware when the firmware was running, else harness. The calling process must have no other threads.
std::vector<CaseRecord> run_in_workers(const std::vector<CaseJob>& jobs, const WorkerOptions& options,
                                       const WorkerEvents& events = {});

}  // namespace forcegate
