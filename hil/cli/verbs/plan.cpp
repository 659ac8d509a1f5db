#include "hil/app/plan.h"

#include <nlohmann/json.hpp>

#include "hil/app/gate.h"
#include "hil/cli/command.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Plan& plan, const PlanEstimate& e) {
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
          {"plan", plan.name},
          {"sha256", plan.sha256},
          {"calibration", std::string(to_string(plan.calibration.level))},
          {"rule", plan.rule.to_text()},
          {"records", e.records},
          {"rig_s", e.rig_s},
          {"bench_s", e.bench_s},
          {"emulated_cpu_s", e.emulated_cpu_s},
          {"cases", cases}};
}

Result<int> run(const Invocation& in) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(in.text("PLAN")));
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  const PlanEstimate estimate = estimate_plan(plan);
  in.console().print(plan_in_words(plan, estimate, in.flag("estimate")));
  in.console().print_json(to_json(plan, estimate).dump(2));
  in.console().next("forcegate gate build/firmware/reference.native.so --plan " + in.text("PLAN"));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "plan",
    .group = "Gate",
    .summary = "check a plan, list its cases, estimate its time",
    .description =
        "A plan says what is played, on which specimens, and what is required of the firmware "
        "(docs/plan.md). Mistakes are named with file, line and column. --estimate adds the time on a real "
        "bench, rests of the specimen included, and on the emulated rig.",
    .positionals = {{.name = "PLAN", .doc = "Plan file, or the name of one in ci/plans."}},
    .options = {{.name = "estimate", .value_name = "", .doc = "Bench time and emulated time."}},
    .examples = {{"forcegate plan bench --estimate", "Does the bench plan fit one shift?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
