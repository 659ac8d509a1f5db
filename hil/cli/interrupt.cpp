#include "hil/cli/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <string>

namespace forcegate {

std::atomic<bool> g_bar_on_terminal{false};

namespace {

std::atomic<bool> g_interrupted{false};
std::atomic<bool> g_catching{false};
std::atomic<int> g_told_by{0};
std::atomic<bool> g_tell_json{false};

// A handler may write, and format nothing.
struct Farewell {
  std::string text, json;
};

Farewell farewell(std::string_view help) {
  const nlohmann::ordered_json error = {{"code", "cancelled"}, {"exit_code", 130}, {"text", "interrupted"}, {"where", ""}, {"help", help}};
  return {"error: interrupted\n" + (help.empty() ? "" : "  help: " + std::string(help) + "\n"), nlohmann::ordered_json{{"error", error}}.dump(2) + "\n"};
}

std::atomic<const Farewell*> g_farewell{nullptr};

static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_interrupt(int) {
  if (g_bar_on_terminal) {
    constexpr char kEraseLine[] = "\r\033[K";
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kEraseLine, sizeof kEraseLine - 1);
  }
  if (g_catching && !g_interrupted.exchange(true)) return;
  if (const Farewell* say = g_farewell; !g_catching && g_told_by == ::getpid() && say != nullptr) {
    [[maybe_unused]] const auto told = g_tell_json ? ::write(STDOUT_FILENO, say->json.data(), say->json.size()) : ::write(STDERR_FILENO, say->text.data(), say->text.size());
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
  static const Farewell kPlain = farewell({});
  g_farewell = &kPlain;
  g_tell_json = json;
  g_told_by = ::getpid();
}

void help_after_interrupt(std::string_view help) {
  static Farewell say;
  say = farewell(help);
  g_farewell = &say;
}

void json_is_told() { g_tell_json = false; }

const std::atomic<bool>& catch_interrupt() {
  g_catching = true;
  return g_interrupted;
}

}  // namespace forcegate
