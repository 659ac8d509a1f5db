#pragma once
// A process of its own that stops the motor when the harness can no longer do it: killed, crashed or hung. It holds
// nothing of the bench until then; the drive's own communication timeout is the second line behind it.

#include <sys/types.h>

#include <functional>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

class ParkGuard {
 public:
  ParkGuard() = default;
  ~ParkGuard() { dismiss(); }
  ParkGuard(const ParkGuard&) = delete;
  ParkGuard& operator=(const ParkGuard&) = delete;

  /// `stop_motor` runs in the guard, once, when this process ends without dismiss() or gives no beat() for silence_s
  /// (0: only when it ends). Call before any instrument is opened.
  Result<void> start(std::function<void()> stop_motor, double silence_s);
  /// False: the guard has left, the motor is stopped or nobody will stop it.
  bool beat() noexcept;
  /// The motor has been stopped in good order: the guard leaves.
  void dismiss() noexcept;
  pid_t id() const { return child_; }

 private:
  pid_t child_ = -1;
  int line_ = -1;
};

}  // namespace forcegate
