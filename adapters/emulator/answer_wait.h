#pragma once
// How long an emulated image has given no answer, by what the emulator did meanwhile: time of the host is nobody's.

#include <sys/types.h>

#include <chrono>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

class AnswerWait {
 public:
  AnswerWait(pid_t emulator, double timeout_s);

  /// An answer came.
  void restart();

  /// To be asked every 100 ms, or as often as one likes. Ok while it may still answer. ErrorCode::firmware: the emulator has computed for timeout_s
  /// (2 s at least, for its own start is not the image's), or none of its threads wanted the processor for that long. Where it
  /// was stopped, or got no processor, for several times as long: ErrorCode::timeout. A gap between two questions (Ctrl-Z of the
  /// whole program, a machine that slept) begins the wait anew.
  Result<void> look(const std::string& what, const std::string& where, const char* hint);

 private:
  using Clock = std::chrono::steady_clock;
  double cpu_s() const;
  pid_t emulator_;
  double timeout_s_;
  Clock::time_point looked_;
  double cpu_at_start_s_ = 0.0, cpu_s_ = 0.0, waited_s_ = 0.0, idle_s_ = 0.0, stopped_s_ = 0.0;
};

}  // namespace forcegate
