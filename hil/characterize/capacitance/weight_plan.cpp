#include "hil/characterize/capacitance/weight_plan.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/model/impedance/bode_fit.h"
#include "hil/rig/config.h"

namespace forcegate::characterize {
namespace {

constexpr const char* kGuide = "docs/characterize.md";

Result<void> read_loading(const ConfigNode& node, WeightPlan& p) {
  ConfigReader r(node, "[loading]", kGuide);
  r.number("step_N", p.step_N, 0.5, 100.0);
  r.number("force_max_N", p.force_max_N, 10.0, 1e4);
  r.number("hold_s", p.hold_s, 0.1, 3600.0);
  r.number("rest_s", p.rest_s, 0.0, 1e9);
  r.count("training", p.training, 2, 50);
  r.count("most_training", p.most_training, 2, 50);
  r.count("testing", p.testing, 1, 50);
  if (r.good() && p.most_training < p.training) r.complain(node, "most_training is less than training");
  if (r.good() && p.force_max_N < 6.0 * p.step_N) r.complain(node, "a loading needs at least six levels");
  return r.finish();
}

Result<void> read_source(const ConfigNode& node, WeightPlan& p) {
  ConfigReader r(node, "[source]", kGuide);
  r.number("dc_V", p.dc_V, -50.0, 50.0);
  r.number("sine_V", p.sine_V, 1e-3, 50.0);
  r.number("sine_Hz", p.sine_Hz, 1.0, 1e6);
  r.count("dc_samples", p.dc_samples, 64, 1 << 20);
  r.count("sine_samples", p.sine_samples, 64, 1 << 20);
  if (r.good() && std::abs(p.dc_V) < 1e-3) r.complain(node, "dc_V must not be 0: eq. (8) divides by it");
  return r.finish();
}

// Frequencies of the sweep that the fit takes.
std::size_t points_of_fit(const WeightPlan& p) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < p.sweep_points; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(p.sweep_points - 1);
    if (p.sweep_low_Hz * std::pow(p.sweep_high_Hz / p.sweep_low_Hz, share) <= impedance::kTopOfBodeFit_Hz) ++out;
  }
  return out;
}

Result<void> read_sweep(const ConfigNode& node, WeightPlan& p) {
  ConfigReader r(node, "[sweep]", kGuide);
  r.number("amplitude_V", p.sweep_V, 1e-3, 50.0);
  r.number("low_Hz", p.sweep_low_Hz, 1.0, 1e6);
  r.number("high_Hz", p.sweep_high_Hz, 1.0, 1e6);
  r.count("points", p.sweep_points, 12, 1000);
  r.count("samples", p.sweep_samples, 64, 1 << 20);
  if (const ConfigNode* forces = r.array("forces_N")) {
    p.sweep_forces_N.clear();
    for (const ConfigNode& item : forces->items) {
      if (!(item.number > 0.0 && item.number <= p.force_max_N)) {
        r.complain(item, "forces_N must hold forces above 0, up to force_max_N");
        break;
      }
      p.sweep_forces_N.push_back(item.number);
    }
    if (r.good() && p.sweep_forces_N.empty()) r.complain(*forces, "forces_N is empty");
  }
  if (r.good() && !(p.sweep_high_Hz > 10.0 * p.sweep_low_Hz))
    r.complain(node, "the sweep must span more than a decade");
  if (const std::size_t fitted = r.good() ? points_of_fit(p) : impedance::kFewestOfBodeFit; fitted < impedance::kFewestOfBodeFit)
    r.complain(node, fmt::format("{} of the {} points of the sweep are at most {} Hz, and the Bode fit of R_s and C_s needs {}", fitted, p.sweep_points,
                                 shortest(impedance::kTopOfBodeFit_Hz), impedance::kFewestOfBodeFit),
               "give more points, or a lower high_Hz");
  return r.finish();
}

}  // namespace

Result<std::string> plan_kind(const std::filesystem::path& path) {
  FORCEGATE_TRY(const ConfigNode root, read_config(path));
  const ConfigNode* kind = root.find("kind");
  if (kind == nullptr || kind->kind != ConfigNode::Kind::text)
    return fail(ErrorCode::config, root.find("case") != nullptr ? "this is a plan of a gate, not of a study" : "the plan says no kind", path.string(),
                root.find("case") != nullptr ? "forcegate gate --plan plays it; the plans of a study that come with the program are characterize, tms and capacitance"
                                             : "write kind = \"characterize\" or \"capacitance\"");
  return kind->text;
}

Result<WeightPlan> parse_weight_plan(std::string_view text, const std::string& name) {
  FORCEGATE_TRY(const ConfigNode root, parse_config(text, name));
  WeightPlan plan;
  plan.path = name;
  ConfigReader r(root, "the plan", kGuide);
  std::int64_t format = 0, seed = static_cast<std::int64_t>(plan.seed);
  std::string kind;
  r.integer("format", format, 1, 1, ConfigReader::required);
  r.text("kind", kind, ConfigReader::required);
  if (r.good() && kind != "capacitance")
    r.complain(*root.find("kind"), "this plan is not one of conductance and capacitance",
               "write kind = \"capacitance\"");
  r.text("name", plan.name, ConfigReader::required);
  r.text("doc", plan.doc);
  r.integer("seed", seed, 0, std::numeric_limits<std::int64_t>::max());
  plan.seed = static_cast<std::uint64_t>(seed);
  const ConfigNode *population = r.table("population"), *loading = r.table("loading"),
                   *source = r.table("source"), *sweep = r.table("sweep");
  FORCEGATE_CHECK_OK(r.finish());
  if (population != nullptr) {
    ConfigReader p(*population, "[population]", kGuide);
    p.count("sets", plan.sets, 1, 10000);
    FORCEGATE_CHECK_OK(p.finish());
  }
  if (loading != nullptr) FORCEGATE_CHECK_OK(read_loading(*loading, plan));
  if (source != nullptr) FORCEGATE_CHECK_OK(read_source(*source, plan));
  if (sweep != nullptr) FORCEGATE_CHECK_OK(read_sweep(*sweep, plan));
  return plan;
}

Result<WeightPlan> read_weight_plan(const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  FORCEGATE_TRY(WeightPlan plan, parse_weight_plan(text, path.string()));
  plan.path = path;
  return plan;
}

}  // namespace forcegate::characterize
