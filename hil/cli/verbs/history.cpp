#include "hil/app/model/history.h"

#include <fmt/format.h>

#include <filesystem>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/next_line.h"

namespace forcegate {
namespace {

// The model file knows the name of the campaign that it was fitted on; its place only where it lies here.
std::string campaign_beside(const Model& model) {
  std::error_code ignored;
  for (auto step = model.history.rbegin(); step != model.history.rend(); ++step)
    for (const char* ending : {"", ".csv"})
      if (!step->campaign.empty() && std::filesystem::exists(step->campaign + ending, ignored)) return step->campaign + ending;
  return {};
}

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("on"), in.text("MODEL")));
  FORCEGATE_TRY(const History answer, history_request(request));
  in.console().print(history_text(answer));
  in.console().print_json(history_json(answer));
  const std::string beside = in.given("on") ? in.text("on") : campaign_beside(answer.model);
  if (leads_to_no_use(answer.model))  // as add goes on: a header of it would be no better
    in.console().next(beside.empty() ? "forcegate history --help" : "forcegate diagnose " + (in.given("on") ? campaign_words(in, beside) : file_quoted(beside)));
  else if (answer.waterfall)
    in.console().next(line_after_fit(in, request.model, in.text("on"), answer.waterfall->end, answer.waterfall->floor));
  else if (!beside.empty())
    in.console().next("forcegate history " + file_quoted(request.model) + " --on " + file_quoted(beside));
  else
    in.console().next(export_line(in, request.model, "").value_or("forcegate history --help"));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "history",
    .group = "Diagnosis",
    .summary = "show how the error of a model fell, step by step",
    .description = "Prints the steps of the model file. With --on CAMPAIGN also the waterfall on held-out "
                   "records: in the order of adding, and averaged over all orders with its range; a bar is "
                   "hollow where the range holds 0.",
    .positionals = {{.name = "MODEL", .doc = "Model file.", .names = Names::input}},
    .options = joined(
        {{{.name = "on", .value_name = "CAMPAIGN", .doc = "Campaign for the waterfall.", .names = Names::campaign}}, campaign_rows()}),
    .examples = {{"forcegate history better.toml --on m7", "Did the error fall?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
