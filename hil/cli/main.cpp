#include <cstdio>
#include <exception>
#include <new>

#include "hil/cli/help.h"
#include "hil/cli/interrupt.h"
#include "hil/cli/lost_input.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

int run(const ParsedLine& line, Console& console, const std::vector<Command>& table) {
  if (line.error) {
    console.error(*line.error);
    return exit_code_of(line.error->code);
  }
  if (line.version) {
    console.print("forcegate " FORCEGATE_VERSION);
    console.print_json("{\"format\": 1, \"version\": \"" FORCEGATE_VERSION "\"}");
    return kExitSuccess;
  }
  if (line.command == nullptr) {
    std::vector<Command> shown;
    for (const Command& c : table)
      if (line.family.empty() || in_family(c.name, line.family)) shown.push_back(c);
    if (line.help) {
      console.print(overview_text(shown, console));
      console.print_json(overview_json(shown));
      return kExitSuccess;
    }
    if (console.json())
      console.error({ErrorCode::usage, "no verb was given", "forcegate", "\"forcegate --help\" lists the verbs"});
    else
      std::fputs(overview_text(shown, console).c_str(), stderr);
    return kExitUsage;
  }
  if (line.help) {
    console.print(command_text(*line.command, console));
    console.print_json(command_json(*line.command));
    return kExitSuccess;
  }
  if (const std::optional<Error> lost = lost_input(*line.command, line.values)) {
    console.error(*lost);
    return exit_code_of(lost->code);
  }
  if (!line.command->hidden) tell_of_interrupt(console.json());
  Invocation invocation(*line.command, console);
  for (const auto& [name, value] : line.values) invocation.set(name, value);
  invocation.set_command_line(line.words);
  const Result<int> code = line.command->run(invocation);
  console.end_progress();
  if (code) return *code;
  console.error(code.error());
  return exit_code_of(code.error().code);
}

}  // namespace
}  // namespace forcegate

int main(int argc, char** argv) {
  using namespace forcegate;
  install_signal_handlers();
  const std::vector<std::string> arguments(argv + (argc > 0 ? 1 : 0), argv + argc);
  const std::vector<Command>& table = Registry<Command>::instance().all();
  const ParsedLine line = parse_command_line(arguments, table);
  Console console(line.console);
  int code = kExitInternal;
  // The last border: a library that throws is a defect here, never an ACCEPT.
  try {
    code = run(line, console, table);
  } catch (const std::bad_alloc&) {
    console.error(
        {ErrorCode::internal, "out of memory", "forcegate", "free memory or judge fewer cases at once"});
  } catch (const std::exception& e) {
    console.error({ErrorCode::internal, std::string("unexpected exception: ") + e.what(), "forcegate",
                   "please report it with the command line"});
  }
  // a full disk behind stdout must not look like success
  if (console.all_written()) return code;
  console.error({ErrorCode::io, "cannot write to standard output", "forcegate", "is the disk full?"});
  return code == kExitSuccess ? int{kExitUsage} : code;
}
