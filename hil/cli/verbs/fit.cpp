#include "hil/app/fit.h"

#include <fmt/format.h>

#include "hil/app/write_file.h"
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
  FORCEGATE_TRY(const diagnose::Refit answer, fit_request(request, ""));
  const std::string output = in.text("output");
  if (!output.empty()) FORCEGATE_CHECK_OK(write_file_atomically(output, write_model(answer.model)));
  in.console().print(refit_text(answer, ""));
  in.console().print_json(refit_json(answer, ""));
  in.console().next("forcegate diagnose " + shell_quoted(in.text("CAMPAIGN")) + (output.empty() ? "" : " --model " + shell_quoted(output)));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "fit",
    .group = "Diagnosis",
    .summary = "fit a model's parameters to a campaign",
    .description = "Fits law and effects together on the records that are not held out, with the repeatability between records estimated from the campaign.",
    .positionals = {{.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run."}},
    .options = {{.name = "output", .value_name = "FILE", .doc = "Model file to write.", .letter = 'o'},
{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate fit m7 -o m7.toml", "A model of this specimen:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
