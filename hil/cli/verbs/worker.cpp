#include "hil/app/play/worker.h"

#include <iostream>
#include <iterator>

#include "hil/cli/command.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  const std::string job{std::istreambuf_iterator<char>(std::cin), {}};
  FORCEGATE_TRY(const std::string record, execute_job_text(job));
  in.console().print(record);
  in.console().print_json(record);
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "worker",
    .group = "Gate",
    .summary = "make one record: job as JSON on stdin, record as JSON on stdout",
    .description =
        "What the gate does in a child process for every record, by hand: under a debugger, or with a "
        "sanitizer. Job and record are not a file format; both ends are one build.",
    .examples = {{"forcegate worker < job.json", "One record:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitInternal},
    .hidden = true,
    .run = run,
}};

}  // namespace
}  // namespace forcegate
