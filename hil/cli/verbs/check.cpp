#include "hil/app/stored/check.h"

#include "hil/app/files/write_file.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace {

// What was judged anew is worth a page; the stored run has its own.
std::string line_after(const Invocation& in, const CheckAnswer& answer) {
  if (!answer.differences.empty()) return "forcegate explain " + std::to_string(kExitInternal);
  if (answer.other_limits && !in.given("output")) return in.command_line() + " -o judged.json";
  const std::string judged = in.given("output") ? in.text("output") : in.text("RUN");
  const std::filesystem::path page = (std::filesystem::path(judged) / "").parent_path().stem();
  return "forcegate report " + file_quoted(judged) + " --format html -o " +
         file_quoted((page.string().find_first_not_of('.') == std::string::npos ? "report" : page.string()) + ".html");
}

Result<int> run(const Invocation& in) {
  CheckRequest request;
  request.run = in.text("RUN");
  if (in.given("limits")) request.limits = in.text("limits");
  if (in.given("plan")) request.plan = in.text("plan");
  if (in.given("today")) request.today = in.text("today");
  request.replay = in.flag("replay");
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  request.threads = static_cast<unsigned>(threads);
  const auto answer = check_run(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!answer) return Unexpected(answer.error());
  if (in.given("output"))
    FORCEGATE_CHECK_OK(write_file_atomically(in.text("output"), to_json(answer->result)));
  in.console().print(check_text(*answer));
  in.console().print_json(check_json(*answer));
  in.console().next(line_after(in, *answer));
  return answer->differences.empty() ? answer->result.decision.exit_code : kExitInternal;
}

const Registration<Command> kRow{Command{
    .name = "check",
    .group = "Gate",
    .summary = "judge a stored run again, without rig and firmware",
    .description =
        "A run's folder is a bundle: bundle.json lists every file that the decision follows from with its SHA-256 (plan, "
        "limits, image, what was measured, kept samples). check verifies the hashes, measures kept samples again, judges, and "
        "compares the result with the stored one byte for byte.\n\nWith --limits or --plan the same records are judged under "
        "other limits; nothing is played. --replay plays the records of an emulated rig again and compares their digests.\n\n"
        "The exit code is that of the decision; 6 when something did not come out the same.",
    .positionals = {{.name = "RUN", .doc = "Folder that forcegate gate -o wrote.", .names = Names::input}},
    .options = {{.name = "limits", .value_name = "FILE", .doc = "Judge under these derived limits.", .names = Names::input},
                {.name = "plan", .value_name = "PLAN", .doc = "Judge under rule and limits of this plan.", .names = Names::input},
                {.name = "today",
                 .value_name = "DATE",
                 .doc = "Day against which the run's waivers expire; default: that of the run."},
                {.name = "replay",
                 .value_name = "",
                 .doc = "Play emulated records again and compare the digests."},
                {.name = "threads",
                 .value_name = "N",
                 .doc = "Worker processes at a time; 0: one per processor.",
                 .fallback = "0"},
                {.name = "output",
                 .value_name = "FILE",
                 .doc = "Write the result as result.json there.",
                 .letter = 'o',
                 .names = Names::file}},
    .examples = {{"forcegate check build/nightly", "Does the stored decision hold?"},
                 {"forcegate check run --limits golden/limits/smoke.toml", "And under other limits?"},
                 {"forcegate check run --replay", "Does this machine make the same samples?"}},
    .exit_codes = {kExitSuccess, kExitReject, kExitUsage, kExitNoDecision, kExitRigFault, kExitSafetyStop,
                   kExitInternal, kExitInterrupted},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
