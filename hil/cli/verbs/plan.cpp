#include "hil/app/gate/plan.h"

#include <nlohmann/json.hpp>

#include "hil/app/files/beside_program.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const PlanEstimate& e) {
  Json cases = Json::array();
  for (const PlanEstimateRow& row : e.cases)
    cases.push_back({{"name", row.name},
                     {"loop", row.loop},
                     {"stimulus", row.stimulus},
                     {"source", row.source},
                     {"specimens", row.specimens},
                     {"record_s", row.record_s},
                     {"bench_s", row.bench_s}});
  return {{"format", 1},
          {"plan", e.name},
          {"sha256", e.sha256},
          {"calibration", e.calibration},
          {"rule", e.rule},
          {"records", e.records},
          {"rig_s", e.rig_s},
          {"bench_s", e.bench_s},
          {"emulated_cpu_s", e.emulated_cpu_s},
          {"cases", cases},
          {"remarks", e.remarks}};
}

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const PlanEstimate estimate, estimate_named_plan(in.text("PLAN")));
  in.console().print(plan_in_words(estimate, in.flag("estimate"), !in.console().quiet()));
  in.console().print_json(to_json(estimate).dump(2));
  const std::optional<std::string> image = shipped_image(estimate.weights ? "two-variable.native.so" : "reference.native.so");
  if (estimate.name == "campaign")  // it judges no firmware
    in.console().next("forcegate record --help");
  else if (estimate.refused)
    in.console().next("mend the plan (docs/plan.md), then: forcegate plan " + file_quoted(in.text("PLAN")));
  else if (estimate.replays)
    in.console().next("judge a recording of yours with it: forcegate gate " + file_quoted(image.value_or("FIRMWARE")) + " --record FILE" +
                      (estimate.name == "replay" ? std::string() : " --plan " + file_quoted(in.text("PLAN"))));
  else
    in.console().next(image ? "forcegate gate " + file_quoted(*image) + " --plan " + file_quoted(in.text("PLAN"))
                            : "gate a build of yours with it: forcegate gate FIRMWARE --plan " + file_quoted(in.text("PLAN")));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "plan",
    .group = "Gate",
    .summary = "check a plan, list its cases, estimate its time",
    .description =
        "A plan says what is played, on which specimens, and what is required of the firmware "
        "(docs/plan.md). Mistakes are named with file, line and column. --estimate adds the time on a real "
        "bench, rests of the specimen included, and on the emulated rig.\n\nThe plans of a study (characterize, tms, capacitance) are not a gate's: forcegate characterize "
        "--plan checks them, before anything is played.",
    .positionals = {{.name = "PLAN", .doc = "Plan file of a gate, or the name of one in ci/plans.", .names = Names::input}},
    .options = {{.name = "estimate", .value_name = "", .doc = "Bench time and emulated time."}},
    .examples = {{"forcegate plan bench --estimate", "Does the bench plan fit one shift?"},
                 {"forcegate plan capacitance-gate --estimate", "And two days of weights?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
