#include "hil/app/history.h"

#include <fmt/format.h>

#include <filesystem>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("on"), in.text("MODEL")));
  FORCEGATE_TRY(const History answer, history_request(request));
  in.console().print(history_text(answer));
  in.console().print_json(history_json(answer));
  const std::string model = shell_quoted(request.model);
  // one recording cannot tell one law for all records from its own repeatability: the model is exported as it was fitted
  const std::filesystem::path on = in.text("on");
  const bool several = std::filesystem::is_directory(on) || on.extension() == ".json";
  if (in.given("on"))
    in.console().next("forcegate export " + model +
                      (several ? " --fit " + campaign_words(in, on.string()) : "") +
                      " --c comp.h puts it into firmware");
  else
    in.console().next("forcegate history " + model + " --on CAMPAIGN");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "history",
    .group = "Diagnosis",
    .summary = "show how the error of a model fell, step by step",
    .description = "Prints the steps of the model file. With --on CAMPAIGN also the waterfall on held-out "
                   "records: in the order of adding, and averaged over all orders with its range; a bar is "
                   "hollow where the range holds 0.",
    .positionals = {{.name = "MODEL", .doc = "Model file."}},
    .options = joined(
        {{{.name = "on", .value_name = "CAMPAIGN", .doc = "Campaign for the waterfall."}}, campaign_rows()}),
    .examples = {{"forcegate history better.toml --on m7", "Did the error fall?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
