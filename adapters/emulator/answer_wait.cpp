#include "adapters/emulator/answer_wait.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kGap_s = 2.0;       // between two looks: the program itself stood still
constexpr double kStep_s = 0.05;
constexpr double kOwnStart_s = 2.0;  // of the emulator's processor time
constexpr double kIdleShare = 0.05, kLeastIdle_s = 0.2;
constexpr double kStarved = 10.0, kStopped = 3.0;  // times the time-out

struct Threads {
  bool want = false, stopped = false;
};

// From /proc; of a process that is gone neither.
Threads threads_of(pid_t pid) {
  Threads out;
  std::error_code ignored;
  for (std::filesystem::directory_iterator at("/proc/" + std::to_string(pid) + "/task", ignored), end; !ignored && at != end; at.increment(ignored)) {
    std::string line;
    std::getline(std::ifstream(at->path() / "stat"), line);
    const std::size_t name_end = line.rfind(')');  // the name may hold anything
    if (name_end == std::string::npos || name_end + 2 >= line.size()) continue;
    const char state = line[name_end + 2];
    out.want = out.want || state == 'R' || state == 'D';
    out.stopped = out.stopped || state == 'T' || state == 't';
  }
  return out;
}

}  // namespace

AnswerWait::AnswerWait(pid_t emulator, double timeout_s) : emulator_(emulator), timeout_s_(timeout_s) { restart(); }

void AnswerWait::restart() {
  looked_ = Clock::now();
  cpu_at_start_s_ = cpu_s_ = cpu_s();
  waited_s_ = idle_s_ = stopped_s_ = 0.0;
}

double AnswerWait::cpu_s() const {
  clockid_t clock;
  timespec t{};
  if (emulator_ <= 0 || clock_getcpuclockid(emulator_, &clock) != 0 || clock_gettime(clock, &t) != 0) return 0.0;
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Result<void> AnswerWait::look(const std::string& what, const std::string& where, const char* hint) {
  const auto now = Clock::now();
  const double step_s = std::chrono::duration<double>(now - looked_).count();
  if (step_s < kStep_s) return {};
  if (step_s > kGap_s) {
    restart();
    return {};
  }
  looked_ = now;
  const double cpu = cpu_s();
  waited_s_ += step_s;
  const Threads threads = threads_of(emulator_);
  if (threads.stopped)
    stopped_s_ += step_s;
  else if (!threads.want && cpu - cpu_s_ < kIdleShare * step_s)
    idle_s_ += step_s;
  cpu_s_ = cpu;
  const std::string text = "the image gives no answer for " + shortest(timeout_s_) + " s";
  if (cpu - cpu_at_start_s_ > std::max(timeout_s_, kOwnStart_s) || idle_s_ > std::max(timeout_s_, kLeastIdle_s))
    return fail(ErrorCode::firmware, text + what, where, hint);
  const bool starved = waited_s_ > (timeout_s_ < kOwnStart_s ? timeout_s_ : kStarved * timeout_s_);
  if (!starved && stopped_s_ <= kStopped * timeout_s_) return {};
  return fail(ErrorCode::timeout, text + what + (threads.stopped ? ": the emulator was stopped" : ": the emulator got no time to compute one"), where,
              "give it a processor, or a longer wait (--lane-option timeout_s=)");
}

}  // namespace forcegate
