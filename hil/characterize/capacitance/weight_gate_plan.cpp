#include "hil/base/digest.h"
#include "hil/base/read_file.h"
#include "hil/characterize/capacitance/weight_gate.h"
#include "hil/rig/config.h"

namespace forcegate::characterize {
namespace {

constexpr const char* kGuide = "docs/two-variable.md";

}  // namespace
Result<WeightGatePlan> read_weight_gate_plan(const std::filesystem::path& path,
                                             const std::filesystem::path& study_path) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  FORCEGATE_TRY(const ConfigNode root, parse_config(text, path.string()));
  WeightGatePlan plan;
  plan.path = path;
  plan.sha256 = sha256_hex(text);
  ConfigReader r(root, "the plan", kGuide);
  std::int64_t format = 0;
  std::string kind, study;
  r.integer("format", format, 1, 1, ConfigReader::required);
  r.text("kind", kind, ConfigReader::required);
  if (r.good() && kind != "capacitance-gate")
    r.complain(*root.find("kind"), "this plan is not one that gates conductance and capacitance",
               "write kind = \"capacitance-gate\"");
  r.text("name", plan.name, ConfigReader::required);
  r.text("doc", plan.doc);
  r.text("study", study, ConfigReader::required);
  const ConfigNode *bench = r.table("bench"), *frame = r.table("frame"), *limits = r.table("limits");
  FORCEGATE_CHECK_OK(r.finish());
  FORCEGATE_TRY(plan.study, read_weight_plan(study_path.empty() ? path.parent_path() / study : study_path));
  if (bench != nullptr) {
    ConfigReader b(*bench, "[bench]", kGuide);
    std::int64_t first = static_cast<std::int64_t>(plan.first_loading);
    b.count("pack", plan.pack, 0, 1'000'000);
    b.integer("first_loading", first, static_cast<std::int64_t>(plan.study.most_training) + 1, 1'000'000'000);
    b.count("loadings", plan.loadings, 2, 100);
    plan.first_loading = static_cast<std::uint64_t>(first);
    FORCEGATE_CHECK_OK(b.finish());
  }
  if (frame != nullptr) {
    ConfigReader f(*frame, "[frame]", kGuide);
    f.number("rate_Hz", plan.rate_Hz, 1000.0, 1e6);
    f.count("direct_samples", plan.direct_samples, 64, 1 << 16);
    f.count("sine_samples", plan.sine_samples, 64, 1 << 16);
    f.number("overdrive_V", plan.overdrive_V, 1e-3, 50.0);
    FORCEGATE_CHECK_OK(f.finish());
  }
  if (limits != nullptr) {
    ConfigReader l(*limits, "[limits]", kGuide);
    l.number("conformance_N", plan.conformance_N, 0.0, 1e3);
    l.number("sensor_mse_N2", plan.sensor_mse_N2, 0.0, 1e6);
    l.number("pack_mse_N2", plan.pack_mse_N2, 0.0, 1e6);
    l.number("pack_per_pct", plan.pack_per_pct, -100.0, 100.0);
    l.number("loss_pct", plan.loss_pct, 0.0, 100.0);
    l.text("goldens", plan.goldens);
    FORCEGATE_CHECK_OK(l.finish());
  }
  return plan;
}

}  // namespace forcegate::characterize
