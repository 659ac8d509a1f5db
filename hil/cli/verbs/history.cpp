#include "hil/app/history.h"

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
  FORCEGATE_TRY(CampaignRequest request, request_of(in, in.text("on")));
  request.model = in.text("MODEL");
  FORCEGATE_TRY(const History answer, history_request(request));
  in.console().print(history_text(answer));
  in.console().print_json(history_json(answer));
  const std::string model = shell_quoted(request.model);
  if (in.given("on"))
    in.console().next("forcegate export " + model + " --fit " + shell_quoted(in.text("on")) + " --c comp.h puts it into firmware");
  else
    in.console().next("forcegate history " + model + " --on CAMPAIGN");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "history",
    .group = "Diagnosis",
    .summary = "show how the error of a model fell, step by step",
    .description = "Prints the steps of the model file. With --on CAMPAIGN also the waterfall on held-out records: in the order of adding, and averaged over all orders with its range; a bar is hollow where the range holds 0.",
    .positionals = {{.name = "MODEL", .doc = "Model file."}},
    .options = {{.name = "on", .value_name = "CAMPAIGN", .doc = "Campaign for the waterfall."},
{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"}},
    .examples = {{"forcegate history better.toml --on m7", "Did the error fall?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
