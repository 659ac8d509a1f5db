#include "hil/cli/verbs/next_line.h"

#include <fmt/format.h>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/files/find_plan.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/campaign_options.h"

namespace forcegate {
namespace {

std::string with_model(const std::string& model) { return model.empty() ? "" : " --model " + file_quoted(model); }

std::vector<std::string> effects_of(const std::string& name) {
  const auto model = load_model(name);
  return model ? engine_options(*model, 1).in_model : std::vector<std::string>{};
}

}  // namespace

std::optional<std::string> export_line(const Invocation& in, const std::string& model, const std::string& campaign) {
  std::optional<CampaignRequest> records;
  // --rate is the firmware's in export, and a late output is nothing that a firmware can undo: such files cannot be named there
  if (!campaign.empty() && !in.given("rate") && !in.given("late")) {
    records.emplace();
    records->campaign = campaign;
    records->maps = in.texts("map");
    records->divider = in.text("divider");
  }
  const bool shipped = is_shipped_model(model);
  const std::optional<ExportOffer> offer = export_offer(model, records ? &*records : nullptr);
  if (!offer || (shipped && !offer->refit)) return std::nullopt;
  std::string out = "forcegate export " + (model.empty() ? "flexiforce" : file_quoted(model));
  if (offer->refit) out += " --fit " + campaign_words(in, campaign);
  if (offer->check) {
    out += " --check " + campaign_words(in, campaign);
    in.console().note(std::string("export --fit is not offered: ") + diagnose::kEffectsOfNoUse + "; what a header of the model as it stands does to these records is checked");
  }
  if (shipped) out += " -o model.toml";
  if (!offer->plan) out += " --plan none";
  if (offer->rate_Hz > 0.0) out += fmt::format(" --rate {:.6g}", offer->rate_Hz);
  return out + " --c comp.h";
}

std::string line_after_diagnosis(const Invocation& in, const Diagnosis& d, const AskedAbout& about) {
  // a model that the sensor's name chose is named, for not every verb sees the campaign
  const std::string model = about.model.empty() && is_shipped_model(d.model) && d.model != "flexiforce" ? d.model : about.model;
  const std::string words = campaign_words(in, about.campaign), both = words + with_model(model);
  // what would be built on such a clock is asked first: seconds are said by --map too
  if (const std::string map = map_of_doubtful_clock(d); !map.empty()) return "forcegate diagnose " + both + " " + map;
  std::optional<std::string> exported;
  Standing standing{.page = about.page, .model_file = !is_shipped_model(model), .experiment = about.experiment};
  standing.in_model = effects_of(model);
  standing.is_exportable = [&] { return (exported = export_line(in, model, about.campaign)).has_value(); };
  const WhatNext what = after_diagnosis(d, standing);
  switch (what.step) {
    case Step::align: return "forcegate diagnose " + campaign_words(in, about.campaign, what.late_s) + with_model(model);
    case Step::add:
      return "forcegate add " + shell_quoted(what.word) + " --fit " + both + " -o " + file_quoted(better_model_name(model));
    case Step::experiment: return "forcegate next " + both;
    case Step::page: return "forcegate diagnose " + both + " --html diagnosis.html";
    case Step::fit: return "forcegate fit " + both + " -o model.toml";
    case Step::compensate: return *exported;
    case Step::record: {
      const std::string plan = plan_that_settles(d);
      return !plan.empty() && find_plan(plan) ? "forcegate plan " + plan : "forcegate record --help";
    }
    case Step::explain: return "forcegate explain " + shell_quoted(what.word);
  }
  return {};
}

std::string line_after_fit(const Invocation& in, const std::string& model, const std::string& campaign, double error, double floor) {
  if (is_noise(error, floor))
    if (const std::optional<std::string> line = export_line(in, model, campaign)) return *line;
  return "forcegate diagnose " + campaign_words(in, campaign) + " --model " + file_quoted(model);
}

}  // namespace forcegate
