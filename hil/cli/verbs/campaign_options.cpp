#include "hil/cli/verbs/campaign_options.h"

#include <fmt/format.h>

#include "hil/cli/parse.h"

namespace forcegate {

Option model_row() {
  return {.name = "model",
          .value_name = "MODEL",
          .doc = "flexiforce, fsr, or a model file; else the one of the sensor that the campaign names, and flexiforce where it names none.",
          .names = Names::input};
}

Option divider_option() {
  return {.name = "divider",
          .value_name = "OHMS:SUPPLY",
          .doc = "The output is that of a divider, 10k:5 with the sensor above the resistor, 10k:5:below with the sensor below: its conductance is read."};
}

std::vector<Option> campaign_rows() {
  return {
      {.name = "map",
       .value_name = "COLUMN=NAME",
       .doc = "Foreign column, for instance pressure_bar=F_ref_N.",
       .repeatable = true},
      {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
      divider_option(),
      {.name = "late", .value_name = "S", .doc = "The output is so late behind the force, seconds: it is set as much earlier.", .fallback = "0"},
      {.name = "threads",
       .value_name = "N",
       .doc = "0: one per processor. The answer does not depend on it.",
       .fallback = "0"}};
}

Positional campaign_positional() {
  return {.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run.", .names = Names::campaign};
}

std::string campaign_words(const Invocation& in, const std::string& campaign, double later_s) {
  std::string out = file_quoted(campaign);
  for (const std::string& map : in.texts("map")) out += " --map " + shell_quoted(map);
  if (in.given("rate")) out += " --rate " + in.text("rate");
  if (in.given("divider")) out += " --divider " + shell_quoted(in.text("divider"));
  if (later_s != 0.0) out += fmt::format(" --late {:.4g}", in.number("late", -kLatest_s, kLatest_s).value_or(0.0) + later_s);
  else if (in.given("late")) out += " --late " + in.text("late");
  return out;
}

std::string model_words(const Invocation& in) {
  return in.given("model") ? " --model " + file_quoted(in.text("model")) : "";
}

std::string named_model(const Invocation& in) { return in.given("model") ? in.text("model") : ""; }

Result<CampaignRequest> campaign_request(const Invocation& in, const std::string& campaign,
                                         const std::string& model) {
  CampaignRequest request;
  request.campaign = campaign;
  request.model = model;
  request.maps = in.texts("map");
  request.divider = in.text("divider");
  FORCEGATE_TRY(request.assumed_rate_Hz, in.number("rate", 0.0, 1e6));
  FORCEGATE_TRY(request.late_s, in.number("late", -kLatest_s, kLatest_s));
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 256));
  request.threads = static_cast<unsigned>(threads);
  return request;
}

}  // namespace forcegate
