#include "hil/app/model/compare.h"

#include <fmt/format.h>

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/report/diagnosis_html.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  const std::string html = in.text("html");
  if (!in.flag("force")) FORCEGATE_CHECK_OK(check_own_file(html, kMarkOfPage));
  if (!html.empty()) FORCEGATE_CHECK_OK(check_writable(html));
  FORCEGATE_TRY(const ModelComparison answer, compare_request(request, !html.empty()));
  if (!html.empty())
    FORCEGATE_CHECK_OK(
        write_file_atomically(html, diagnosis_html(answer.view, {FORCEGATE_VERSION, in.command_line(), true, answer.pictures})));
  in.console().print(comparison_text(answer));
  in.console().notes(answer.view.notes);
  in.console().print_json(comparison_json(answer));
  in.console().next(answer.too_short ? "forcegate record --help" : "forcegate diagnose " + campaign_words(in, in.text("CAMPAIGN")) + model_words(in));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "compare",
    .group = "Diagnosis",
    .summary = "say how far a model is from measurements, and where it fails",
    .description = "Error of the model on every record, as written and refitted, beside the floor (noise and steps of the "
                   "instruments, as the samples show them), and the quantities that the residual depends on.",
    .positionals = {campaign_positional()},
    .options = joined({{{.name = "html", .value_name = "FILE", .doc = "Write the pictures.", .names = Names::file}, model_row()},
                       campaign_rows(),
                       {force_row()}}),
    .examples = {{"forcegate compare m7", "How far is the built-in model from the campaign m7:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
