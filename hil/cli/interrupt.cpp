#include "hil/cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

namespace forcegate {

std::atomic<bool> g_bar_on_terminal{false};

namespace {

std::atomic<bool> g_interrupted{false};
std::atomic<bool> g_catching{false};
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_interrupt(int) {
  if (g_bar_on_terminal) {
    constexpr char kEraseLine[] = "\r\033[K";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kEraseLine, sizeof kEraseLine - 1);
  }
  if (g_catching && !g_interrupted.exchange(true)) return;
  ::_exit(130);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
  ::sigaction(SIGXFSZ, &action, nullptr);  // a limit on the size of files is a failed write, told like a full disk
}

const std::atomic<bool>& catch_interrupt() {
  g_catching = true;
  return g_interrupted;
}

}  // namespace forcegate
