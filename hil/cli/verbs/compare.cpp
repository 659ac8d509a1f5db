#include "hil/app/compare.h"

#include <fmt/format.h>

#include "hil/app/write_file.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/report/diagnosis_html.h"

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
  FORCEGATE_TRY(const Comparison answer, compare_request(request));
  if (const std::string html = in.text("html"); !html.empty())
    FORCEGATE_CHECK_OK(write_file_atomically(html, diagnosis_html(answer.view, {FORCEGATE_VERSION, in.command_line()})));
  in.console().print(comparison_text(answer));
  in.console().print_json(comparison_json(answer));
  in.console().next("forcegate diagnose " + shell_quoted(in.text("CAMPAIGN")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "compare",
    .group = "Diagnosis",
    .summary = "say how far a model is from measurements, and where it fails",
    .description = "Error of the model on every record, as written and refitted, beside the floor that the declared instruments allow, and the quantities that the residual depends on.",
    .positionals = {{.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run."}},
    .options = {{.name = "html", .value_name = "FILE", .doc = "Write the pictures."},
{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate compare m7", "How far is the built-in model from the campaign m7:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
