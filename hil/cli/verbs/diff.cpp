#include "hil/app/stored/run_diff.h"

#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const RunDiff diff, diff_runs(in.text("RUN_A"), in.text("RUN_B")));
  in.console().print(diff_text(diff));
  in.console().print_json(diff_json(diff));
  in.console().next("forcegate report " + file_quoted(in.text("RUN_B")) + " --format html -o b.html");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "diff",
    .group = "Gate",
    .summary = "compare two runs case by case, with uncertainties",
    .description =
        "Pairs the records of two runs by case and specimen and shows how each error changed. Records of one plan and seed "
        "share profile, specimen and noise, so what is common drops out: the interval of a mean difference comes from the "
        "spread of the single ones. When plan, seed, rig, its faults and options or the calibrations differ, that is said first.\n\nRuns are compared, not judged: to "
        "judge a build against limits use gate, to judge a stored run again use check.",
    .positionals = {{.name = "RUN_A", .doc = "Folder of a run, or its result.json: the accepted build.", .names = Names::input},
                    {.name = "RUN_B", .doc = "The same of the candidate.", .names = Names::input}},
    .examples = {{"forcegate diff accepted candidate", "Is the candidate worse?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
