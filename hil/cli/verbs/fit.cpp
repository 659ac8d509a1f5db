#include "hil/app/model/fit.h"

#include <fmt/format.h>

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/cli/verbs/next_line.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  const std::string output = in.text("output");
  if (!in.flag("force")) FORCEGATE_CHECK_OK(check_own_file(output, kMarkOfModel));
  FORCEGATE_TRY(const diagnose::Refit answer, fit_request(request, ""));
  if (!output.empty()) FORCEGATE_CHECK_OK(write_file_atomically(output, write_model(answer.model)));
  in.console().print(refit_text(answer, "", !in.console().quiet()));
  in.console().print_json(refit_json(answer, ""));
  if (output.empty())
    in.console().next("forcegate fit " + campaign_words(in, in.text("CAMPAIGN")) + model_words(in) + " -o model.toml");
  else
    in.console().next(line_after_fit(in, output, in.text("CAMPAIGN"), answer.error_after, answer.floor));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "fit",
    .group = "Diagnosis",
    .summary = "fit a model's parameters to a campaign",
    .description = "Fits law and effects together on the records that are not held out, with the "
                   "repeatability between records estimated from the campaign.",
    .positionals = {campaign_positional()},
    .options =
        joined({{{.name = "output", .value_name = "FILE", .doc = "Model file to write.", .letter = 'o', .names = Names::file},
                 model_row()},
                campaign_rows(),
                {force_row()}}),
    .examples = {{"forcegate fit m7 -o m7.toml", "A model of this specimen:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
