#include "hil/app/power/power.h"

#include "hil/app/files/beside_program.h"
#include "hil/app/files/write_file.h"
#include "hil/base/text.h"
#include "hil/cli/command.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  PowerRequest request;
  request.firmware = in.text("firmware");
  std::error_code ignored;
  if (!in.given("firmware") && !std::filesystem::is_directory(request.firmware, ignored)) request.firmware = program_folder() / "firmware";
  request.plan = in.text("plan");
  FORCEGATE_TRY(const std::int64_t seeds, in.integer("seeds", 0, 100000));
  FORCEGATE_TRY(const std::int64_t mutant_seeds, in.integer("mutant-seeds", 0, 100000));
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  FORCEGATE_TRY(const std::int64_t family_seeds, in.integer("family-seeds", 0, 100000));
  FORCEGATE_TRY(const std::int64_t panel_seeds, in.integer("panel-seeds", 0, 100000));
  request.seeds = static_cast<std::size_t>(seeds);
  request.family_seeds = static_cast<std::size_t>(family_seeds);
  request.panel_seeds = static_cast<std::size_t>(panel_seeds);
  request.panel_plan = in.text("panel-plan");
  if (in.given("journal")) request.journal = in.text("journal");
  request.mutant_seeds = static_cast<std::size_t>(mutant_seeds);
  request.threads = static_cast<unsigned>(threads);
  request.quick = in.flag("quick");
  request.only = in.texts("mutant");
  if (in.given("markdown")) request.markdown = in.text("markdown");
  Console& console = in.console();
  const auto result = measure_power(request, console.progress_callback(), &in.interrupt_flag());
  console.end_progress();
  if (!result) {
    Error error = result.error();
    if (error.code == ErrorCode::cancelled)
      error.hint = in.given("journal") ? "what was played is in " + in.text("journal") + ": the same command goes on from there" : "with --journal FILE the same command goes on from where it was";
    return Unexpected(std::move(error));
  }
  if (in.given("markdown"))
    FORCEGATE_CHECK_OK(write_file_atomically(in.text("markdown"), power_markdown(*result)));
  if (in.given("out")) FORCEGATE_CHECK_OK(write_file_atomically(in.text("out"), power_json(*result) + "\n"));
  console.print(power_text(*result));
  console.print_json(power_json(*result));
  console.print(result->good() && result->nothing_played()
                   ? "no mutant was played: nothing is said of what slips through (--mutant-seeds 1 plays each once)"
               : result->good()
                   ? "the gate sees what it claims to see; docs/power.md explains the table"
               : result->nothing_asked() ? "nothing was gated: no run of the reference or of a mutant was asked for (--seeds, --mutant-seeds)"
               : result->nothing_built() ? "no mutant is built in " + request.firmware.string() + ": nothing was gated (ninja mutants)"
                   : "write the check that sees a survivor, or say in its 'note:' why there is none");
  return result->good() ? kExitSuccess : kExitReject;
}

const Registration<Command> kRow{Command{
    .name = "power",
    .group = "Gate",
    .summary = "how good is the gate: reject every deliberately bad firmware, accept every good one",
    .description = "Gates every mutant of the reference firmware (rigs/firmware/mutants) under the shortest "
                   "plan that exercises "
                   "each limit, and the reference itself over many seeds. Prints who is rejected by which "
                   "check, the smallest "
                   "defect found, the probability that a bad build slips through and that a good one is "
                   "refused, and the "
                   "survivors: those are the next checks to write.\n\nThe column \"blind\" says whether a "
                   "build would have been "
                   "rejected had no independent implementation of its algorithm been known.",
    .options =
        {{.name = "plan",
          .value_name = "PLAN",
          .doc = "Plan file, or the name of one in ci/plans.",
          .fallback = "power",
          .names = Names::input},
         {.name = "firmware",
          .value_name = "FOLDER",
          .doc = "Folder of the images, mutants in its subfolder mutants.",
          .fallback = "build/firmware",
          .names = Names::input},
         {.name = "seeds", .value_name = "N", .doc = "Runs of the reference.", .fallback = "59"},
         {.name = "mutant-seeds", .value_name = "N", .doc = "Runs of each mutant.", .fallback = "1"},
         {.name = "family-seeds",
          .value_name = "N",
          .doc =
              "Runs of each level of a graded family (gain off by 1, 2, 5 % ...) if more than --mutant-seeds; the rest as with --quick.",
          .fallback = "1"},
         {.name = "panel-seeds",
          .value_name = "N",
          .doc = "Runs of the reference under --panel-plan too.",
          .fallback = "0"},
         {.name = "panel-plan",
          .value_name = "PLAN",
          .doc = "Plan on the panel of specimens, for --panel-seeds.",
          .fallback = "panel",
          .names = Names::input},
         {.name = "journal",
          .value_name = "FILE",
          .doc = "Keep what is done, one line each; the same command goes on from there after an interrupt."},
         {.name = "mutant", .value_name = "NAME", .doc = "Only this mutant or family.", .repeatable = true},
         {.name = "quick",
          .value_name = "",
          .doc = "A bad build is done with at the first case that rejects it as expected."},
         {.name = "threads",
          .value_name = "N",
          .doc = "Worker processes at a time; 0: one per processor.",
          .fallback = "0"},
         {.name = "markdown", .value_name = "FILE", .doc = "Write the page docs/power.md there.", .names = Names::file},
         {.name = "out", .value_name = "FILE", .doc = "Write the table as JSON.", .letter = 'o', .names = Names::file}},
    .examples =
        {{"forcegate power --quick", "Every mutant once, the reference over 59 seeds:"},
         {"forcegate power --mutant gain_pct --mutant-seeds 59 --seeds 0",
          "How small a gain error is found:"},
         {"forcegate power --seeds 0 --mutant-seeds 0 --family-seeds 0 --panel-seeds 300 --journal panel.jsonl",
          "How often is a good build refused, on nine specimens, over 300 seeds (interrupt it, go on later):"},
         {"forcegate power --seeds 59 --family-seeds 20 --panel-seeds 300 --markdown docs/power.md",
          "The page of the documentation:"}},
    .exit_codes = {kExitSuccess, kExitReject, kExitUsage, kExitInternal, kExitInterrupted},
    .reject_text = "A bad build was not rejected as it should be, a good one was not accepted, or nothing was gated.",
    .run = run,
}};

}  // namespace
}  // namespace forcegate
