#pragma once
// What a verb says: results on stdout, progress and notes on stderr. The only place of the program that writes there.

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

enum class Paint { plain, strong, dim, pass, fail, warn };

struct ConsoleOptions {
  bool json = false;
  bool quiet = false;
  enum class Color { automatic, always, never } color = Color::automatic;
};

class Console {
 public:
  /// Colour: --color first, then NO_COLOR (off), CLICOLOR_FORCE (on), then whether stdout is a terminal.
  explicit Console(ConsoleOptions options, std::FILE* out = stdout, std::FILE* err = stderr);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  bool json() const { return options_.json; }
  bool quiet() const { return options_.quiet; }
  bool color() const { return color_; }

  /// Result for a person: one or more lines on stdout. Silent with --json; --quiet does not silence it.
  void print(std::string_view text);
  /// Result for a program: one JSON document on stdout, only with --json.
  void print_json(std::string_view document);
  /// A note on stderr. Silent with --quiet or --json.
  void note(std::string_view text);
  /// Notes of an answer, below it: "note: ...". Silent with --quiet or --json.
  void notes(const std::vector<std::string>& notes);
  /// Last line: what to do next ("next: forcegate check build/run"). Silent with --quiet or --json.
  void next(std::string_view what);
  /// A file made for people to look at: the command that opens it where this machine has one (xdg-open, open), else its name.
  void look_at(const std::string& file);
  /// The error as text on stderr, or as {"error": {...}} on stdout with --json, as long as stdout takes it.
  void error(const Error& error);
  /// What went wrong beside an answer that was given: as text on stderr, with --json too.
  void error_beside(const Error& error);

  /// Hands on what was printed before anything else happens, also into a pipe or a file.
  void flush();
  /// Flushes stdout. False when any of it was lost (a full disk); a reader that has left is its own affair.
  bool all_written();

  /// Escape codes around `text` when colour is on, else `text`.
  std::string paint(Paint role, std::string_view text) const;

  /// Progress: fraction in [0, 1] of the whole and what is being done now. On a terminal a bar at 10 Hz with the
  /// time left; otherwise a plain line every 10 % or 10 s. Silent with --quiet. May be called from any thread.
  void progress(double fraction, std::string_view now);
  /// Removes the bar. print, note, next and error do it themselves.
  void end_progress();
  /// progress() as a callback for hil/app.
  std::function<void(double, std::string_view)> progress_callback();

 private:
  void clear_bar();
  void print_error(const Error& error);
  ConsoleOptions options_;
  std::FILE* out_;
  std::FILE* err_;
  bool color_ = false;
  struct Bar;
  std::unique_ptr<Bar> bar_;
};

}  // namespace forcegate
