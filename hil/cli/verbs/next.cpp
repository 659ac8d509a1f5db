#include "hil/app/next_run.h"

#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/interface/rig.h"

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

Result<int> play(const Invocation& in) {
  NextRunRequest request;
  FORCEGATE_TRY(request.campaign, request_of(in, in.text("CAMPAIGN")));
  request.bench.rig = in.text("rig");
  for (const std::string& word : in.texts("rig-option")) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail(ErrorCode::usage, "'" + word + "' is not NAME=VALUE", "--rig-option");
    request.bench.rig_options[word.substr(0, equals)] = word.substr(equals + 1);
  }
  for (const std::string& file : in.texts("record")) request.recorded.push_back(file);
  if (in.given("record") && !in.given("rig")) request.bench.rig = "replay";
  if (request.bench.rig == "replay" && request.recorded.empty())
    return fail(ErrorCode::usage, "the rig replay needs recordings", "--record", "give each of them with --record FILE");
  request.bench.specimen = in.text("specimen");
  FORCEGATE_TRY(request.bench.seed, in.seed("seed"));
  request.output = in.text("output");
  const auto made = next_run(request, in.console().progress_callback(), &in.interrupt_flag());
  in.console().end_progress();
  if (!made) return Unexpected(made.error());
  in.console().print(next_run_text(*made));
  in.console().print_json(next_run_json(*made));
  const std::string folder = shell_quoted(made->folder.string());
  for (const Finding& f : made->after.findings)
    if (f.probability >= 0.5) {
      in.console().next("forcegate add " + f.effect + " --fit " + folder + " -o better.toml");
      return kExitSuccess;
    }
  in.console().next("forcegate next " + folder);
  return kExitSuccess;
}

Result<int> run(const Invocation& in) {
  if (in.flag("run")) return play(in);
  FORCEGATE_TRY(const CampaignRequest request, request_of(in, in.text("CAMPAIGN")));
  FORCEGATE_TRY(const NextExperiment answer, next_request(request));
  in.console().print(next_text(answer));
  in.console().print_json(next_json(answer));
  if (!answer.segments.empty()) in.console().next("forcegate next " + shell_quoted(in.text("CAMPAIGN")) + " --run on your rig, or record it yourself and add --record FILE");
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "next",
    .group = "Diagnosis",
    .summary = "say what to measure next so that look-alike effects part",
    .description = "Plans one to four pieces of rig time, the best per minute, that separate the effects which compete for the explanation; each is simulated for all rivals and the rival is refitted inside.\n\n"
                   "--run plays them on a rig, appends the records to a copy of the campaign (nothing is overwritten) and diagnoses again: "
                   "odds before, expected and now. With --record the segments are picked from files that you recorded.",
    .positionals = {{.name = "CAMPAIGN", .doc = "Campaign folder, campaign.json, one CSV or one HDF5 run."}},
    .options = {{.name = "model", .value_name = "MODEL", .doc = "flexiforce, fsr, or a model file.", .fallback = "flexiforce"},
                {.name = "map", .value_name = "COLUMN=NAME", .doc = "Foreign column, for instance pressure_bar=F_ref_N.", .repeatable = true},
                {.name = "rate", .value_name = "HZ", .doc = "Sampling rate of files without a clock.", .fallback = "0"},
                {.name = "threads", .value_name = "N", .doc = "0: one per processor. The answer does not depend on it.", .fallback = "0"},
                {.name = "run", .value_name = "", .doc = "Play them and diagnose again."},
                {.name = "rig", .value_name = "NAME|FILE", .doc = "Rig to play on, or a bench file.", .fallback = "emulated",
                 .choices = [] { return Registry<RigKind>::instance().names(); }, .only_choices = false},
                {.name = "rig-option", .value_name = "NAME=VALUE", .doc = "Option of the rig.", .repeatable = true},
                {.name = "record", .value_name = "FILE", .doc = "A recording that may be one of the segments (rig replay).", .repeatable = true},
                {.name = "specimen", .value_name = "NAME", .doc = "Which sensor lies on the bench.", .fallback = "q50"},
                {.name = "seed", .value_name = "N", .doc = "Seed of the emulated rig, as when the campaign was recorded.", .fallback = "1"},
                {.name = "output", .value_name = "FOLDER", .doc = "New campaign; default: CAMPAIGN-next.", .letter = 'o'}},
    .examples = {{"forcegate next m7", "Which records would settle it:"},
                 {"forcegate next m7 --run --rig-option hidden=creep:strong", "Play them on the emulated rig and ask again:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
