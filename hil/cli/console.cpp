#include "hil/cli/console.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/interrupt.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

using SteadyClock = std::chrono::steady_clock;

bool environment_set(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

bool wants_color(ConsoleOptions::Color color, std::FILE* out) {
  if (color != ConsoleOptions::Color::automatic) return color == ConsoleOptions::Color::always;
  if (environment_set("NO_COLOR")) return false;
  if (environment_set("CLICOLOR_FORCE") && std::string_view(std::getenv("CLICOLOR_FORCE")) != "0")
    return true;
  const char* terminal = std::getenv("TERM");
  return ::isatty(::fileno(out)) != 0 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

int terminal_width(std::FILE* file) {
  winsize size{};
  if (::ioctl(::fileno(file), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

// Cut at a code point, so that the bar never ends in half a character.
std::string cut(std::string_view text, std::size_t columns) {
  std::size_t used = 0, i = 0;
  while (i < text.size()) {
    std::size_t next = i + 1;
    while (next < text.size() && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80) ++next;
    if (++used > columns) break;
    i = next;
  }
  return std::string(text.substr(0, i));
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(std::lround(seconds));
  if (s < 100) return fmt::format("{} s", s);
  if (s < 6000) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
}

bool is_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path == nullptr ? "" : path, ':'))
    if (!folder.empty() && ::access((folder + "/" + name).c_str(), X_OK) == 0) return true;
  return false;
}

// What opens a file as a double click would. On Linux `open` may be another program.
std::string opener() {
#ifdef __APPLE__
  const std::string program = "open";
#else
  const std::string program = "xdg-open";
#endif
  return is_program(program) ? program : "";
}

}  // namespace

struct Console::Bar {
  std::mutex mutex;
  bool terminal = false;
  bool running = false;
  SteadyClock::time_point started, last;
  int last_percent = 0;
};

Console::Console(ConsoleOptions options, std::FILE* out, std::FILE* err)
    : options_(options),
      out_(out),
      err_(err),
      color_(wants_color(options.color, out)),
      bar_(std::make_unique<Bar>()) {
  bar_->terminal = ::isatty(::fileno(err)) != 0;
}

Console::~Console() { end_progress(); }

void Console::clear_bar() {
  if (g_bar_on_terminal.exchange(false)) {
    std::fputs("\r\033[K", err_);
    std::fflush(err_);
  }
}

void Console::print(std::string_view text) {
  if (options_.json) return;
  const std::lock_guard lock(bar_->mutex);
  clear_bar();
  std::fwrite(text.data(), 1, text.size(), out_);
  if (text.empty() || text.back() != '\n') std::fputc('\n', out_);
}

void Console::print_json(std::string_view document) {
  if (!options_.json) return;
  const std::lock_guard lock(bar_->mutex);
  clear_bar();
  json_is_told();
  std::fwrite(document.data(), 1, document.size(), out_);
  if (document.empty() || document.back() != '\n') std::fputc('\n', out_);
}

void Console::note(std::string_view text) {
  if (options_.json || options_.quiet) return;
  const std::lock_guard lock(bar_->mutex);
  clear_bar();
  std::fwrite(text.data(), 1, text.size(), err_);
  std::fputc('\n', err_);
}

void Console::notes(const std::vector<std::string>& notes) {
  if (options_.quiet) return;
  for (const std::string& text : notes) print("note: " + text);
}

void Console::next(std::string_view what) {
  if (options_.json || options_.quiet) return;
  print(paint(Paint::dim, "next: " + std::string(what)));
}

void Console::look_at(const std::string& file) {
  if (options_.json || options_.quiet) return;
  if (const std::string program = opener(); !program.empty()) return next(program + " " + file_quoted(file));
  print(paint(Paint::dim, "look at: " + file));
}

void Console::flush() {
  const std::lock_guard lock(bar_->mutex);
  std::fflush(out_);
}

bool Console::all_written() {
  if (std::fflush(out_) == 0 && std::ferror(out_) == 0) return true;
  pollfd reader{::fileno(out_), POLLOUT, 0};
  return ::poll(&reader, 1, 0) > 0 && (reader.revents & (POLLERR | POLLHUP)) != 0;
}

void Console::error(const Error& error) {
  end_progress();
  const std::lock_guard lock(bar_->mutex);
  if (options_.json && all_written()) {
    const nlohmann::ordered_json document = {{"error",
                                              {{"code", to_string(error.code)},
                                               {"exit_code", exit_code_of(error.code)},
                                               {"text", printable_utf8(error.text)},
                                               {"where", printable_utf8(error.where)},
                                               {"help", printable_utf8(error.hint)}}}};
    std::fputs((document.dump(2) + "\n").c_str(), out_);
    if (all_written()) return;
  }
  print_error(error);
}

void Console::error_beside(const Error& error) {
  end_progress();
  const std::lock_guard lock(bar_->mutex);
  print_error(error);
}

void Console::print_error(const Error& error) {
  std::string text = printable_utf8(error.to_text());
  constexpr std::string_view kHead = "error:";
  if (color_ && text.starts_with(kHead)) text = paint(Paint::fail, kHead) + text.substr(kHead.size());
  std::fflush(out_);
  std::fputs((text + "\n").c_str(), err_);
}

std::string Console::paint(Paint role, std::string_view text) const {
  const char* code = "";
  switch (role) {
    case Paint::plain: break;
    case Paint::strong: code = "1"; break;
    case Paint::dim: code = "2"; break;
    case Paint::pass: code = "1;38;5;36"; break;
    case Paint::fail: code = "1;38;5;166"; break;
    case Paint::warn: code = "1;38;5;136"; break;
  }
  if (!color_ || *code == '\0') return std::string(text);
  return fmt::format("\033[{}m{}\033[0m", code, text);
}

void Console::progress(double fraction, std::string_view now) {
  if (options_.quiet) return;
  const std::lock_guard lock(bar_->mutex);
  Bar& bar = *bar_;
  const auto time = SteadyClock::now();
  if (!bar.running) {
    bar.running = true;
    bar.started = bar.last = time;
    bar.last_percent = 0;
    if (bar.terminal) bar.last -= std::chrono::seconds(1);
  }
  fraction = std::clamp(std::isnan(fraction) ? 0.0 : fraction, 0.0, 1.0);
  const int percent = static_cast<int>(fraction * 100.0);
  const double since_last_s = std::chrono::duration<double>(time - bar.last).count();
  const double elapsed_s = std::chrono::duration<double>(time - bar.started).count();
  if (bar.terminal) {
    if (since_last_s < 0.1) return;
    const int filled = static_cast<int>(fraction * 20.0);
    std::string line = fmt::format("[{}{}] {:3} %", std::string(static_cast<std::size_t>(filled), '#'),
                                   std::string(static_cast<std::size_t>(20 - filled), '.'), percent);
    if (fraction > 0.02 && elapsed_s > 1.0)
      line += "  " + duration_text(elapsed_s * (1.0 - fraction) / fraction) + " left";
    line += "  " + printable_utf8(now);
    std::replace(line.begin(), line.end(), '\n', ' ');
    g_bar_on_terminal = true;
    std::fputs(("\r" + cut(line, static_cast<std::size_t>(std::max(20, terminal_width(err_) - 1))) + "\033[K")
                   .c_str(),
               err_);
  } else {
    if (percent / 10 == bar.last_percent / 10 && since_last_s < 10.0) return;
    std::fputs(fmt::format("{:3} %  {}\n", percent, printable_utf8(now)).c_str(), err_);
  }
  std::fflush(err_);
  bar.last = time;
  bar.last_percent = percent;
}

void Console::end_progress() {
  const std::lock_guard lock(bar_->mutex);
  clear_bar();
  bar_->running = false;
}

std::function<void(double, std::string_view)> Console::progress_callback() {
  return [this](double fraction, std::string_view now) { progress(fraction, now); };
}

}  // namespace forcegate
