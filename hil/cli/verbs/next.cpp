#include "hil/app/next.h"

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
  FORCEGATE_TRY(const NextExperiment answer, next_request(request));
  in.console().print(next_text(answer));
  in.console().print_json(next_json(answer));
  if (!answer.segments.empty()) in.console().next("record it into " + shell_quoted(in.text("CAMPAIGN")) + ", then: forcegate diagnose " + shell_quoted(in.text("CAMPAIGN")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "next",
    .group = "Diagnosis",
    .summary = "say what to measure next so that look-alike effects part",
    .description = "Plans one to four pieces of rig time, the best per minute, that separate the effects which compete for the explanation; each is simulated for all rivals and the rival is refitted inside.",
    .positionals = {{.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run."}},
    .options = {{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate next m7", "Which records would settle it:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
