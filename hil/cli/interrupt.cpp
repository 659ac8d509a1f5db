#include "hil/cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

namespace forcegate {

std::atomic<bool> g_bar_on_terminal{false};

namespace {

std::atomic<bool> g_interrupted{false};
std::atomic<bool> g_catching{false};
std::atomic<int> g_told_by{0};
std::atomic<bool> g_tell_json{false};

// A handler may write, and format nothing.
constexpr char kText[] = "error: interrupted\n";
constexpr char kJson[] =
    "{\n  \"error\": {\n    \"code\": \"cancelled\",\n    \"exit_code\": 130,\n    \"text\": \"interrupted\",\n    \"where\": \"\",\n    \"help\": \"\"\n  }\n}\n";

static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_interrupt(int) {
  if (g_bar_on_terminal) {
    constexpr char kEraseLine[] = "\r\033[K";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kEraseLine, sizeof kEraseLine - 1);
  }
  if (g_catching && !g_interrupted.exchange(true)) return;
  if (!g_catching && g_told_by == ::getpid()) {
    [[maybe_unused]] const auto told = g_tell_json ? ::write(STDOUT_FILENO, kJson, sizeof kJson - 1) : ::write(STDERR_FILENO, kText, sizeof kText - 1);
  }
  ::_exit(130);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  // A terminal that is closed ends a run as Ctrl-C does; under nohup it ends none.
  struct sigaction before {};
  if (::sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &action, nullptr);
  ::sigaction(SIGXFSZ, &action, nullptr);  // a limit on the size of files is a failed write, told like a full disk
}

void tell_of_interrupt(bool json) {
  g_tell_json = json;
  g_told_by = ::getpid();
}

void json_is_told() { g_tell_json = false; }

const std::atomic<bool>& catch_interrupt() {
  g_catching = true;
  return g_interrupted;
}

}  // namespace forcegate
