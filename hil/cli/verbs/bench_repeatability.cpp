#include "hil/app/bench/rig_check.h"
#include "hil/app/files/write_file.h"
#include "hil/app/power/limits.h"
#include "hil/base/utc_clock.h"
#include "hil/cli/command.h"
#include "hil/cli/verbs/limits_line.h"
#include "hil/cli/verbs/rig_choice.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  RepeatabilityRequest request;
  request.gate.firmware = in.text("FIRMWARE");
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  request.gate.rig = std::move(rig.rig);
  request.gate.rig_options = std::move(rig.options);
  request.gate.plan = in.text("plan");
  if (in.given("seed")) {
    FORCEGATE_TRY(request.gate.seed, in.seed("seed"));
  }
  FORCEGATE_TRY(const std::int64_t n, in.integer("count", 5, 10000));
  request.n = static_cast<std::size_t>(n);
  request.date = utc_today();
  if (in.given("output")) FORCEGATE_CHECK_OK(check_limits_output(in.text("output"), request.gate.plan));
  const auto answer = repeatability(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!answer) return Unexpected(answer.error());
  if (in.given("output"))
    FORCEGATE_CHECK_OK(write_file_atomically(in.text("output"), write_limits(answer->limits)));
  in.console().print(repeatability_text(*answer));
  in.console().print_json(repeatability_json(*answer));
  in.console().next(in.given("output") ? line_after_limits(in, answer->limits, in.text("output"), rig_words(in))
                                       : in.command_line() + " -o limits.toml");
  const bool all = answer->limits.by_case_and_check.size() == answer->rows.size() && !answer->rows.empty();
  return all ? kExitSuccess : kExitNoDecision;
}

const Registration<Command> kRow{Command{
    .name = "bench repeatability",
    .group = "Bench",
    .summary = "measure how a rig repeats, and write limits it can resolve",
    .description = "Plays the open-loop cases of a plan again and again with one known-good build: mean, "
                   "spread and largest error, and the "
                   "share of each limit that the rig's own spread takes (%GRR). A limit of which it takes "
                   "more than 30 % is refused: "
                   "such a rig would decide by chance. What is left goes into a limits file with n, date and "
                   "rig id; forcegate bless "
                   "puts it in force.\n\nExit code 3: at least one limit was refused.",
    .positionals = {{.name = "FIRMWARE", .doc = "Known-good firmware image.", .names = Names::input}},
    .options = joined(
        {rig_rows(),
         {{.name = "plan", .value_name = "PLAN", .doc = "What is played.", .fallback = "selfcheck", .names = Names::input},
          {.name = "count", .value_name = "N", .doc = "How often.", .fallback = "20"},
          {.name = "seed", .value_name = "N", .doc = "First seed of the emulated rig; default: the plan's."},
          {.name = "output", .value_name = "FILE", .doc = "Write the limits there.", .letter = 'o', .names = Names::file}}}),
    .examples =
        {{"forcegate bench repeatability build/firmware/reference.native.so --count 20 -o limits.toml",
          "Twenty times the known profile:"}},
    .exit_codes = {kExitSuccess, kExitUsage, kExitNoDecision, kExitRigFault, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
