#pragma once
// The command table. A verb is one row, registered by one file hil/cli/verbs/<verb>.cpp:
//
//   namespace forcegate { namespace {
//   Result<int> run(const Invocation& in) {
//     FORCEGATE_TRY(const double duration_s, in.number("duration", 0.0, 86400.0));
//     in.console().print("text for stdout");
//     in.console().next("forcegate check " + folder);
//     return kExitSuccess;
//   }
//   const Registration<Command> kRow{Command{.name = "gate", .group = "Gate", ..., .run = run}};
//   } }
//
// Parsing, --help, completion, man page, "did you mean" and the checks of choices come from the table. The row
// turns an Invocation into a request of hil/app, calls it and prints the answer; it holds no other logic.

#include <atomic>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/cli/console.h"

namespace forcegate {

/// Exit codes of every verb.
enum ExitCode : int {
  kExitSuccess = 0,        ///< ACCEPT, or the verb did what it was asked
  kExitReject = 1,         ///< REJECT: the firmware failed a required check on a sound rig
  kExitUsage = 2,          ///< command line, plan, bench or data file is wrong
  kExitNoDecision = 3,     ///< NO-DECISION: somebody must act before there can be a verdict
  kExitRigFault = 4,       ///< the rig misbehaved; the only code after which a retry makes sense
  kExitSafetyStop = 5,     ///< safety stop of undecided cause
  kExitInternal = 6,       ///< a defect of Forcegate
  kExitInterrupted = 130,  ///< Ctrl-C
};

int exit_code_of(ErrorCode code);

using Choices = std::function<std::vector<std::string>()>;

/// The file or folder that a value names: an output that is an input of the same line is refused (lost_input.h).
enum class Names {
  nothing,   ///< no file, or one that the verb itself looks after (a journal that it goes on with)
  input,     ///< is read
  campaign,  ///< is read, with the recordings in it or beside it
  file,      ///< is written
  records,   ///< a folder is written, files named as the recordings that are read
  folder,    ///< a folder is written, under names of the verb's own
};

struct Option {
  std::string name;          ///< "record" for --record
  std::string value_name;    ///< "FILE", "N", "SECONDS"; empty: a flag without value
  std::string doc;           ///< one sentence
  std::string fallback{};    ///< value when not given; empty: none
  Choices choices{};         ///< values to offer; empty function: free text (completed as file names)
  bool only_choices = true;  ///< false: choices are offered, others are allowed too ("--rig NAME|FILE")
  bool required = false;
  bool repeatable = false;  ///< Invocation::texts gives all of them
  char letter = 0;          ///< 'o' for -o; 0: none
  Names names = Names::nothing;
};

/// The lists one after the other.
std::vector<Option> joined(std::initializer_list<std::vector<Option>> lists);

struct Positional {
  std::string name;  ///< "FIRMWARE"
  std::string doc;
  bool required = true;
  bool repeatable = false;  ///< only the last one may be
  Choices choices{};
  bool only_choices = true;
  bool list_choices = true;  ///< false: --help shows them in another way (details)
  Names names = Names::nothing;
};

struct Example {
  std::string command;  ///< "forcegate gate build/firmware/reference-m4f.block.elf"
  std::string doc;      ///< what it shows, one line
};

class Invocation;

struct Command {
  std::string name;
  std::string group;        ///< "Gate", "Traces", "Diagnosis", "House": heading in the overview
  std::string summary;      ///< one line without a period
  std::string description;  ///< teaches: what it does, what comes out, what to know; paragraphs by "\n\n"
  std::vector<Positional> positionals{};
  std::vector<Option> options{};  ///< besides --json, --color, --quiet and --help, which every verb has
  std::vector<Example> examples{};
  std::function<std::string()>
      details{};  ///< text of --help that is only known at run time (lists of plug-ins)
  std::vector<int> exit_codes = {kExitSuccess, kExitUsage};  ///< those it can give, for --help
  std::string reject_text{};  ///< of exit code 1 in --help, where the verb judges no firmware
  bool hidden = false;                                       ///< not in overview and completion ("worker")
  /// Exit code, or an Error that is printed (text or JSON) and mapped by exit_code_of.
  std::function<Result<int>(const Invocation&)> run{};
};

/// One argument as it was written.
struct LineWord {
  std::string quoted;  ///< for a POSIX shell
  std::string option;  ///< whose it is, name or value; "": of none in the verb's table
};

/// One parsed command line. Options and positionals are asked by their names in the table; asking for a name that is
/// not in the row is an assert.
class Invocation {
 public:
  Invocation(const Command& command, Console& console) : command_(&command), console_(&console) {}

  const Command& command() const { return *command_; }
  Console& console() const { return *console_; }
  bool json() const { return console_->json(); }

  /// The user gave it (a fallback does not count).
  bool given(std::string_view name) const;
  bool flag(std::string_view name) const { return given(name); }
  /// Last value given, else the fallback, else "".
  std::string text(std::string_view name) const;
  /// All values given, in order; one fallback when none was given and there is one.
  std::vector<std::string> texts(std::string_view name) const;
  /// Decimal number within [low, high]; anything else is a usage error that names option, value and range.
  Result<double> number(std::string_view name, double low, double high) const;
  Result<std::int64_t> integer(std::string_view name, std::int64_t low, std::int64_t high) const;
  /// Full 64-bit seed, decimal or 0x hexadecimal.
  Result<std::uint64_t> seed(std::string_view name) const;

  /// "forcegate gate x.elf --seed 7" quoted for a POSIX shell: the line that repeats this run.
  std::string command_line() const { return command_line_without(""); }
  /// The same line without an option of the table, however it was written.
  std::string command_line_without(std::string_view option) const;

  /// From this call on the first Ctrl-C sets the flag instead of ending the program (the second ends it). The verb
  /// then stops, parks the rig and returns ErrorCode::cancelled.
  const std::atomic<bool>& interrupt_flag() const;

  /// For the parser and for tests of verbs.
  void set(const std::string& name, std::string value) { values_[name].push_back(std::move(value)); }
  void set_command_line(std::vector<LineWord> words) { words_ = std::move(words); }

 private:
  const std::string* fallback_of(std::string_view name) const;
  const Command* command_;
  Console* console_;
  std::map<std::string, std::vector<std::string>, std::less<>> values_;
  std::vector<LineWord> words_;
};

}  // namespace forcegate
