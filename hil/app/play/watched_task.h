#pragma once
// Work with code of a firmware image, which may crash or hang: every task runs in a forked child of its own, watched
// through a page that both share, and its text comes back over a pipe. Two instances in one process would share static
// state.

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/firmware_guard.h"

namespace forcegate {

struct WorkerOptions {
  unsigned workers = 0;      ///< at a time; 0: one per processor
  double hang_cpu_s = 10.0;  ///< CPU time without progress inside the firmware that counts as a hang
  double blocked_s = 30.0;   ///< wall time without progress and without CPU time; a block takes milliseconds
  const std::atomic<bool>* cancelled = nullptr;
};

/// What a caller may show while tasks run. Called from the calling thread.
struct WorkerEvents {
  std::function<void(std::size_t task, double t_s)> progress;
  std::function<void(std::size_t task)> done;
  /// Before done, of a task that gave no answer but whose image had said who it is.
  std::function<void(std::size_t task, const FirmwareGuard&)> died = nullptr;
  /// Of a task that was not begun because its image had not come back from another one.
  std::function<void(std::size_t task)> given_up = nullptr;
};

struct WatchedTask {
  std::string id;  ///< where of its errors
  /// Runs in the child, with stdin and stdout at /dev/null. `progress` tells the time in the record, s.
  std::function<Result<std::string>(const std::function<void(double t_s)>& progress)> work;
  /// Once an image hangs, no other task of it is begun: each would cost the same time for the same answer. "": none.
  std::string image = {};
};

/// Runs every task and returns the texts in their order, whatever the number of workers. An error of `work` comes back as
/// it was. A child that dies or hangs gives ErrorCode::firmware, with signal and block, when it was inside the image
/// (FirmwareGuard), when a thread other than its own crashed after the image was loaded, or when the process sent itself
/// a signal or ended itself then, left a process behind or closed the pipe of its answer; else internal. Whatever a task
/// started ends with it. One that is stopped from outside or interrupted gives cancelled. The
/// calling process must have no other threads.
std::vector<Result<std::string>> run_watched(const std::vector<WatchedTask>& tasks,
                                             const WorkerOptions& options, const WorkerEvents& events = {});

}  // namespace forcegate
