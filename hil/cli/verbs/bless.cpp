#include "hil/app/stored/bless.h"

#include <algorithm>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/limits_line.h"

namespace forcegate {
namespace {

bool in_force(const BlessAnswer& answer) { return std::ranges::none_of(answer.changes, &BlessChange::changed); }

std::string line_after(const BlessRequest& asked, const BlessAnswer& answer) {
  if (answer.written) {
    const std::string files = file_quoted(answer.target.string()) + " " + file_quoted(answer.governance.string());
    return "git add " + files + " && git commit -m " + shell_quoted(asked.reason) + " -- " + files;
  }
  std::error_code ignored;
  if (in_force(answer)) return std::filesystem::is_directory(asked.source, ignored) ? "forcegate check " + file_quoted(asked.source.string()) : "forcegate gate --help";
  return bless_line(asked.source.string(), shell_quoted(asked.reason), shell_quoted(asked.who)) +
         (asked.goldens.empty() ? "" : " --goldens " + file_quoted(asked.goldens.string())) + (asked.plan.empty() ? "" : " --plan " + file_quoted(asked.plan));
}

Result<int> run(const Invocation& in) {
  BlessRequest request;
  request.source = in.text("SOURCE");
  request.who = in.text("who");
  request.reason = in.text("reason");
  if (in.given("goldens")) request.goldens = in.text("goldens");
  if (in.given("plan")) request.plan = in.text("plan");
  request.dry_run = in.flag("dry-run");
  FORCEGATE_TRY(const BlessAnswer answer, bless(request));
  in.console().print(bless_text(answer));
  if (!answer.written && in_force(answer)) in.console().print("nothing has to be done: these are in force already\n");
  in.console().print_json(bless_json(answer));
  in.console().next(line_after(request, answer));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "bless",
    .group = "Gate",
    .summary = "make a run's traces, or derived limits, the new golden ones",
    .description =
        "Goldens and derived limits change in no other way. SOURCE is the folder of a run that is accepted apart from its "
        "goldens, or a file made by forcegate limits. The table says what changes; a line in CHANGES.md beside the goldens "
        "keeps date, name, reason, firmware hash, rig and calibration.\n\nA golden keeps its tolerances when it is renewed: "
        "they are edited by hand, in the file, and show in the review.",
    .positionals = {{.name = "SOURCE", .doc = "Folder of a run, or a limits file.", .names = Names::input}},
    .options = {{.name = "reason", .value_name = "TEXT", .doc = "Why it changes.", .required = true},
                {.name = "who", .value_name = "NAME", .doc = "Who answers for it.", .required = true},
                {.name = "goldens",
                 .value_name = "FOLDER",
                 .doc = "Where the goldens are; default: as the plan says, seen from its file.",
                 .names = Names::folder},
                {.name = "plan", .value_name = "PLAN", .doc = "Whose limits or goldens these are, a file or a name; default: the plan that the limits name, or that the run was gated with.", .names = Names::input},
                {.name = "dry-run", .value_name = "", .doc = "Only show what would change."}},
    .examples = {{"forcegate bless run --reason \"first goldens of the smoke plan\" --who \"A. Smith\"",
                  "After an accepted run:"},
                 {"forcegate bless new.toml --reason \"spring replaced\" --who \"A. Smith\" --dry-run",
                  "What would new limits change?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
