#include "hil/app/model/simulate.h"

#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"
#include "hil/cli/verbs/force_row.h"

namespace forcegate {
namespace {

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, campaign_request(in, in.text("CAMPAIGN"), named_model(in)));
  FORCEGATE_TRY(const Simulation answer, simulate_request(request, in.text("output"), &in.interrupt_flag(), in.flag("force")));
  in.console().print(simulation_text(answer));
  in.console().notes(answer.notes);
  nlohmann::ordered_json records = nlohmann::ordered_json::array();
  for (const Simulation::Item& item : answer.items)
    records.push_back({{"record", printable_utf8(item.record)},
                       {"file", printable_utf8(item.file.string())},
                       {"rows", item.rows},
                       {"rmse_V", item.rmse_V ? nlohmann::ordered_json(*item.rmse_V) : nlohmann::ordered_json(nullptr)}});
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const std::string& note : answer.notes) notes.push_back(printable_utf8(note));
  in.console().print_json(
      nlohmann::ordered_json{{"format", 1}, {"unit", answer.unit}, {"model_unit", answer.model_unit}, {"records", records}, {"notes", notes}}.dump(2));
  in.console().next("forcegate compare " + campaign_words(in, in.text("CAMPAIGN")) + model_words(in));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "simulate",
    .group = "Diagnosis",
    .summary = "let a model answer to the forces of a campaign",
    .description = "Writes one CSV per record with time, force, measured output and the model's output, on rows of which at most 50 come in a "
                   "second: faster samples are means over 20 ms.",
    .positionals = {campaign_positional()},
    .options = joined(
        {{{.name = "output", .value_name = "DIR", .doc = "Folder to write.", .required = true, .letter = 'o', .names = Names::records},
          model_row(), force_row()},
         campaign_rows()}),
    .examples = {{"forcegate simulate m7 --model better.toml -o out", "The model's own curves:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
