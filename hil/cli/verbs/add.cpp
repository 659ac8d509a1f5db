#include "hil/app/add.h"

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
  AddRequest request;
  request.effect = in.text("EFFECT");
  FORCEGATE_TRY(request.campaign, request_of(in, in.text("fit")));
  request.output = in.text("output");
  FORCEGATE_TRY(const diagnose::Refit answer, add_request(request));
  in.console().print(refit_text(answer, request.effect));
  in.console().print_json(refit_json(answer, request.effect));
  if (request.output.empty())
    in.console().next("the same with -o better.toml, which keeps it");
  else
    in.console().next("forcegate history " + shell_quoted(request.output.string()) + " --on " + shell_quoted(in.text("fit")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "add",
    .group = "Diagnosis",
    .summary = "add a physical effect to a model and refit everything",
    .description = "Adds one effect of the library, refits all parameters together, shows how much each old one moved and what the error on held-out records did, and keeps the step in the model's history.",
    .positionals = {{.name = "EFFECT", .doc = "Name of the effect.", .choices = [] { return EffectRegistry::instance().names(); }}},
    .options = {{.name = "fit", .value_name = "CAMPAIGN", .doc = "Campaign to fit on.", .required = true},
                {.name = "output", .value_name = "FILE", .doc = "Model file to write.", .letter = 'o'},
{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate add hysteresis --fit m7 -o better.toml", "Add a loop and watch the error:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
