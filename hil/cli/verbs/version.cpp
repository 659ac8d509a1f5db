#include "hil/cli/command.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  in.console().print("forcegate " FORCEGATE_VERSION "\ncompiler " __VERSION__);
  in.console().print_json("{\"format\": 1, \"version\": \"" FORCEGATE_VERSION
                          "\", \"compiler\": \"" __VERSION__ "\"}");
  in.console().next("forcegate doctor");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "version",
    .group = "House",
    .summary = "version and compiler of this binary",
    .description =
        "Prints the version of Forcegate and the compiler that made it. Every result file carries both: "
        "identical bytes are promised for one build on one release of the operating system.",
    .examples = {{"forcegate version --json", "The same for a program:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
