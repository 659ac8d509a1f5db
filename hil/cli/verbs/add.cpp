#include "hil/app/model/add.h"

#include <fmt/format.h>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/diagnose/what_next.h"
#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/app/model/weak_addition.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/cli/verbs/next_line.h"

namespace forcegate {
namespace {

// What helps is a law for all records: export refits it. Empty where that is refused.
std::string one_law_line(const Invocation& in, const std::string& output) {
  if (output.empty())
    return "forcegate add " + shell_quoted(in.text("EFFECT")) + " --fit " + campaign_words(in, in.text("fit")) + model_words(in) + " -o " +
           file_quoted(better_model_name(named_model(in)));
  const std::string line = export_line(in, output, in.text("fit")).value_or("");
  return line.find(" --fit ") != std::string::npos ? line : "";
}

Result<int> run(const Invocation& in) {
  AddRequest request;
  request.effect = in.text("EFFECT");
  FORCEGATE_TRY(request.campaign, campaign_request(in, in.text("fit"), named_model(in)));
  request.output = in.text("output");
  const std::string html = in.text("html");
  if (!in.flag("force")) {
    FORCEGATE_CHECK_OK(check_own_file(request.output, kMarkOfModel));
    FORCEGATE_CHECK_OK(check_own_file(html, kMarkOfPage));
  }
  if (!request.output.empty()) FORCEGATE_CHECK_OK(check_writable(request.output));
  if (!html.empty()) FORCEGATE_CHECK_OK(check_writable(html));
  FORCEGATE_TRY(const diagnose::Refit answer, add_request(request));
  // the answer first: it stands, whatever becomes of its page
  in.console().print(refit_text(answer, request.effect, !in.console().quiet()));
  if (!html.empty()) {
    FORCEGATE_TRY(const std::string page, added_page(request, answer, in.command_line()));
    FORCEGATE_CHECK_OK(write_file_atomically(html, page));
    in.console().note("wrote " + html);
  }
  in.console().print_json(refit_json(answer, request.effect));  // one document: an error of the page would be a second
  const std::string model = named_model(in);
  const bool for_all = helps_one_law(answer) && weak_addition(answer, request.effect).is_shown;
  if (const std::string line = for_all ? one_law_line(in, request.output.string()) : ""; !line.empty())
    in.console().next(line);
  else if (!is_needed(answer) || !weak_addition(answer, request.effect).is_shown) {  // what else is it? A diagnosis that claims it would lead back here
    const Result<Diagnosis> other = diagnose_request(request.campaign);
    in.console().next(other && leads_to_add(*other, request.effect) ? "forcegate explain " + shell_quoted(request.effect)
                                                                   : "forcegate diagnose " + campaign_words(in, in.text("fit")) + model_words(in));
  } else if (request.output.empty())
    in.console().next("forcegate add " + shell_quoted(request.effect) + " --fit " + campaign_words(in, in.text("fit")) + model_words(in) +
                      " -o " + file_quoted(better_model_name(model)));
  else
    in.console().next("forcegate history " + file_quoted(request.output.string()) + " --on " +
                      campaign_words(in, in.text("fit")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "add",
    .group = "Diagnosis",
    .summary = "add a physical effect to a model and refit everything",
    .description =
        "Adds one effect, of the library or an equation of your own, refits all parameters together, shows how much each old one moved "
        "and what the error on held-out records did, and keeps the step in the model's history.",
    .positionals = {{.name = "EFFECT",
                     .doc = "Name of the effect: one of the library, or of an [[effect]] with equations in the model file.",
                     .choices = [] { return EffectRegistry::instance().names(); },
                     .only_choices = false}},
    .options =
        joined({{{.name = "fit", .value_name = "CAMPAIGN", .doc = "Campaign to fit on.", .required = true, .names = Names::campaign},
                 {.name = "output", .value_name = "FILE", .doc = "Model file to write.", .letter = 'o', .names = Names::file},
                 {.name = "html", .value_name = "FILE", .doc = "Write the pictures, before and after.", .names = Names::file},
                 model_row()},
                campaign_rows(),
                {force_row()}}),
    .examples = {{"forcegate add hysteresis --fit m7 -o better.toml", "Add a loop and watch the error:"},
                 {"forcegate add creep --fit m7 -o better.toml --html creep.html", "The same with pictures:"},
                 {"forcegate add softening --model mine.toml --fit m7 -o better.toml", "Fit an equation of the model file:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
