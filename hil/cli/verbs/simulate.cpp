#include "hil/app/simulate.h"

#include <fmt/format.h>

#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

Result<CampaignRequest> request_of(const Invocation& in, const std::string& campaign) {
  CampaignRequest request;
  request.campaign = campaign;
  request.model = in.text("model");
  request.maps = in.texts("map");
  FORCEGATE_TRY(request.assumed_rate_Hz, in.number("rate", 0.0, 1e6));
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 256));
  request.threads = static_cast<unsigned>(threads);
  return request;
}

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const CampaignRequest request, request_of(in, in.text("CAMPAIGN")));
  FORCEGATE_TRY(const Simulation answer, simulate_request(request, in.text("output")));
  std::string json = "{\"format\": 1, \"records\": [";
  for (const auto& item : answer.items) {
    in.console().print(fmt::format("{}: {} rows, model against measurement {:.3g} mV RMS", item.file.string(), item.rows, 1e3 * item.rmse_V));
    json += fmt::format("{}{{\"record\": \"{}\", \"rows\": {}, \"rmse_V\": {:.9g}}}", json.back() == '[' ? "" : ", ", item.record, item.rows, item.rmse_V);
  }
  in.console().print_json(json + "]}");
  in.console().next("forcegate compare " + shell_quoted(in.text("CAMPAIGN")) + " --model " + shell_quoted(request.model));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "simulate",
    .group = "Diagnosis",
    .summary = "let a model answer to the forces of a campaign",
    .description = "Writes one CSV per record with time, force, measured output and the model's output.",
    .positionals = {{.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run."}},
    .options = {{.name = "output", .value_name = "DIR", .doc = "Folder to write.", .required = true, .letter = 'o'},
{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate simulate m7 --model better.toml -o out", "The model's own curves:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
