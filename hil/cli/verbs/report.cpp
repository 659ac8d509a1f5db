#include "hil/app/stored/report.h"

#include <nlohmann/json.hpp>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/interface/reporter.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  ReportRequest request{in.text("RESULT"), in.text("format"), in.text("output"), in.console().color(), in.flag("force")};
  FORCEGATE_TRY(const ReportAnswer answer, render_report(request));
  if (in.given("output"))
    in.console().note("written " + in.text("output") + " (" + std::to_string(answer.text.size()) + " bytes)");
  else
    in.console().print(answer.text);
  in.console().print_json(nlohmann::ordered_json{
      {"format", 1},
      {"view", request.format},
      {"decision", to_string(answer.result.decision.kind)},
      {"reason", answer.result.decision.reason},
      {"output", in.text("output")},
      {"bytes",
       answer.text.size()}}.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  if (in.given("output") && request.format == "html")
    in.console().look_at(in.text("output"));
  else if (request.format == "console" || in.given("output")) in.console().next("forcegate explain " + std::string(to_string(answer.result.decision.kind)));
  return kExitSuccess;
}

std::string views() {
  std::string out = "Views:\n";
  for (const ReporterKind& kind : Registry<ReporterKind>::instance().all())
    out += "  " + kind.name + std::string(kind.name.size() < 10 ? 10 - kind.name.size() : 1, ' ') + kind.doc +
           "\n";
  return out;
}

const Registration<Command> kRow{Command{
    .name = "report",
    .group = "Gate",
    .summary = "show a stored result in another form",
    .description = "A gate run leaves one result.json; every other view is made from it and can be made "
                   "again at any time, without "
                   "rig or firmware. The decision is the stored one: to judge again, use check.\n\nThe text "
                   "goes to stdout, or to "
                   "the file of --output.",
    .positionals = {{.name = "RESULT", .doc = "result.json, or the folder of a run.", .names = Names::input}},
    .options =
        {{.name = "format",
          .value_name = "VIEW",
          .doc = "Which view.",
          .fallback = "console",
          .choices = report_formats},
         {.name = "output", .value_name = "FILE", .doc = "Write the view to this file.", .letter = 'o', .names = Names::file},
         force_row()},
    .examples = {{"forcegate report run/result.json", "The decision again:"},
                 {"forcegate report run --format html -o report.html",
                  "One page with pictures, to send to somebody:"},
                 {"forcegate report run --format github", "Annotations for a pull request:"}},
    .details = views,
    .run = run,
}};

}  // namespace
}  // namespace forcegate
