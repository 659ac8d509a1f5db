#include "hil/app/bench/rig_check.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/rig_choice.h"

namespace forcegate {
namespace {

// The same build on the rig that is fit, under the plan that judges.
std::string line_that_gates(const Invocation& in) {
  std::string out = "forcegate gate " + file_quoted(in.text("FIRMWARE")) + rig_words(in);
  for (const char* option : {"record", "map", "cal"})
    for (const std::string& word : in.texts(option)) out += std::string(" --") + option + " " + shell_quoted(word);
  return out;
}

Result<int> run(const Invocation& in) {
  SelfcheckRequest request;
  GateRequest& gated = request.gate;
  gated.firmware = in.text("FIRMWARE");
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  FORCEGATE_CHECK_OK(take_recording(in, rig));
  gated.rig = std::move(rig.rig);
  gated.rig_options = std::move(rig.options);
  gated.plan = in.given("plan") ? in.text("plan") : gated.rig == "replay" ? "replay" : "selfcheck";
  if (in.given("cal")) gated.calibration_file = in.text("cal");
  if (in.given("seed")) {
    FORCEGATE_TRY(gated.seed, in.seed("seed"));
  }
  gated.output = in.text("output");
  gated.command_line = in.command_line();
  gated.started_at = utc_now();
  gated.today = gated.started_at.substr(0, 10);
  if (in.given("history")) request.history = in.text("history");
  const auto answer = selfcheck(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!answer) return Unexpected(answer.error());
  in.console().print(selfcheck_text(*answer));
  in.console().print_json(selfcheck_json(*answer));
  if (!answer->fit) in.console().print("mend what is named, then check again");
  in.console().next(answer->fit ? line_that_gates(in) : in.command_line());
  return answer->fit ? kExitSuccess : kExitRigFault;
}

const Registration<Command> kRow{Command{
    .name = "bench selfcheck",
    .group = "Bench",
    .summary = "say whether a rig is fit to judge a build",
    .description = "Plays a known profile with a known-good build and looks at the rig: unloaded reading "
                   "before and after, noise, "
                   "stiffness of the spring, following error, clocks, lost samples, sensor channel, and the "
                   "error of the build itself. "
                   "With --history every visit is kept in a file, and a control chart over the accepted visits of "
                   "this rig with the same known-good build (single values and "
                   "their moving mean) says when the rig has drifted, long before a limit is passed.\n\nExit "
                   "code 4: the rig is not fit.",
    .positionals = {{.name = "FIRMWARE", .doc = "Known-good firmware image.", .names = Names::input}},
    .options = joined(
        {rig_rows(),
         {{.name = "record", .value_name = "FILE", .doc = "Recording to look at (rig replay).", .names = Names::input},
          map_row(),
          {.name = "cal",
           .value_name = "FILE",
           .doc = "Calibration of the specimen instead of measuring it.",
           .names = Names::input},
          {.name = "plan", .value_name = "PLAN", .doc = "Known profile; default: selfcheck, or replay.", .names = Names::input},
          {.name = "seed", .value_name = "N", .doc = "Seed of the emulated rig; default: the plan's."},
          {.name = "history", .value_name = "FILE", .doc = "File of all visits; this one is added to it."},
          {.name = "output", .value_name = "FOLDER", .doc = "Keep the whole result there.", .letter = 'o', .names = Names::folder}}}),
    .examples = {{"forcegate bench selfcheck build/firmware/reference.native.so --history bench.jsonl",
                  "Every morning:"},
                 {"forcegate bench selfcheck build/firmware/reference.native.so --record yesterday.csv --cal "
                  "cal.toml",
                  "On a recording:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitRigFault, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
