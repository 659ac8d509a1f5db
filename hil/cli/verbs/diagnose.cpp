#include "hil/app/diagnose/diagnose.h"

#include <fmt/format.h>

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/app/pictures/pictures.h"
#include "hil/base/plain_number.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/cli/verbs/next_line.h"
#include "hil/report/diagnosis_html.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  Console& console = in.console();
  RecordPictures pictures;
  const std::string html = in.text("html"), folder = in.text("pictures");
  const bool drawn = !html.empty() || !folder.empty();
  if (!in.flag("force")) FORCEGATE_CHECK_OK(check_own_file(html, kMarkOfPage));
  if (!html.empty()) FORCEGATE_CHECK_OK(check_writable(html));
  if (!folder.empty()) FORCEGATE_CHECK_OK(check_writable(std::filesystem::path(folder) / "ranking.svg"));
  FORCEGATE_TRY(const Diagnosis answer, diagnose_request(request, drawn ? &pictures : nullptr));
  // the answer first: it stands, whatever becomes of its pictures
  console.print(diagnosis_text(answer));
  console.notes(answer.notes);
  if (!html.empty()) {
    FORCEGATE_CHECK_OK(
        write_file_atomically(html, diagnosis_html(answer, {FORCEGATE_VERSION, in.command_line(), false, pictures})));
    console.note("wrote " + html);
  }
  if (!folder.empty()) {
    FORCEGATE_TRY(const auto files, write_pictures(answer, pictures, folder, in.flag("force")));
    console.note("wrote " + counted(files.size(), "picture") + " into " + folder);
  }
  console.print_json(to_json(answer));  // one document: an error of the pictures would be a second
  console.next(line_after_diagnosis(in, answer,
                                    {.campaign = in.text("CAMPAIGN"), .model = named_model(in), .page = !html.empty()}));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "diagnose",
    .group = "Diagnosis",
    .summary = "say which physical effect is missing between a model and measurements",
    .description =
        "Reads a campaign (folder with campaign.json, or one CSV), fits the starting model with the "
        "repeatability of "
        "the records, and compares every effect of the library on what is left: which one explains it, on "
        "which side "
        "(sensor, rig, reference, instrument), how sure, what it can be mistaken for, and what to measure "
        "next. The "
        "answer can be \"none\", or \"unknown\" with the quantities that the remaining structure depends on.",
    .positionals = {campaign_positional()},
    .options = joined(
        {{model_row()},
         campaign_rows(),
         {{.name = "html", .value_name = "FILE", .doc = "Write the report with its pictures.", .names = Names::file},
          {.name = "pictures", .value_name = "FOLDER", .doc = "Write every picture as an SVG of its own.", .names = Names::folder},
          force_row()}}),
    .examples = {{"forcegate diagnose m7", "What is missing in the campaign m7:"},
                 {"forcegate diagnose m7 --html m7.html", "The same with pictures:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
