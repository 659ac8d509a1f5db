#include "hil/app/gate/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "hil/app/files/find_plan.h"
#include "hil/app/gate/plan_remarks.h"
#include "hil/app/gate/weight_gate.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/gate/case_result.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

constexpr double kWeightSample_s =
    35e-9;  // measured: capacitance-gate, 10.6 million samples with training in 0.38 s

constexpr const char* kRecorded = "recorded";  // the specimen of a recording

double duration_s(const StimulusSpec& spec) {
  const auto made = make_stimulus(spec);
  return made ? (*made)->duration_s() : 0.0;
}

std::string hours(double s) {
  if (s < 120.0) return fmt::format("{:.3g} s", s);
  if (s < 7200.0) return fmt::format("{:.0f} min", s / 60.0);
  return fmt::format("{:.1f} h", s / 3600.0);
}

}  // namespace

PlanEstimate estimate_plan(const Plan& plan, double rate_Hz, double ns_per_sample) {
  PlanEstimate e;
  e.name = plan.name, e.doc = plan.doc, e.sha256 = plan.sha256;
  e.calibration = to_string(plan.calibration.level);
  e.rule_name = plan.rule.name, e.rule = plan.rule.to_text(), e.looks = plan.rule.looks;
  std::set<std::string> specimens;
  for (const PlanCase& c : plan.cases) {
    PlanEstimateRow row;
    row.name = c.name;
    row.loop = to_string(c.loop);
    row.stimulus = stimulus_in_words(c.stimulus);
    row.source = c.source;
    row.specimens = specimens_of(plan, c).size();
    row.record_s = duration_s(c.stimulus);
    row.bench_s = static_cast<double>(row.specimens) * (row.record_s + std::min(c.rest_before_s, 86400.0));
    specimens.insert(specimens_of(plan, c).begin(), specimens_of(plan, c).end());
    e.records += row.specimens;
    e.rig_s += static_cast<double>(row.specimens) * row.record_s;
    e.bench_s += row.bench_s;
    e.cases.push_back(std::move(row));
  }
  const PlanCalibration& cal = plan.calibration;
  double record_s = 0.0, rest_s = 0.0;
  if (cal.level != CalibrationLevel::nominal) {
    record_s += cal.sweep_s * cal.sweeps;
    rest_s += cal.rest_s;
  }
  if (cal.level == CalibrationLevel::identified && cal.identification) {
    record_s += duration_s(cal.identification->stimulus);
    rest_s += cal.rest_s;
  }
  e.replays = specimens.size() == 1 && specimens.contains(kRecorded);
  const double n = static_cast<double>(specimens.size());
  e.calibration_bench_s = n * (record_s + rest_s);
  e.rig_s += n * record_s;
  e.bench_s += e.calibration_bench_s;
  e.emulated_cpu_s = e.rig_s * rate_Hz * ns_per_sample * 1e-9;
  return e;
}

PlanEstimate estimate_plan(const characterize::WeightGatePlan& plan, const WeightBenchInfo& bench) {
  const characterize::WeightPlan& study = plan.study;
  PlanEstimate e;
  e.name = plan.name, e.doc = plan.doc, e.sha256 = plan.sha256;
  e.weights = true;
  e.calibration = to_string(CalibrationLevel::nominal);
  e.rule_name = plan.rule.name, e.rule = plan.rule.to_text(), e.looks = plan.rule.looks;
  const auto sensors = static_cast<double>(bench.sensors);
  const double levels = std::floor(study.force_max_N / study.step_N + 1e-9);
  double samples = 0.0;
  const auto add = [&](std::string name, std::size_t loadings, std::size_t codes, double rate_Hz,
                       std::string source) {
    PlanEstimateRow row;
    row.name = std::move(name);
    row.loop = to_string(LoopMode::open);
    row.stimulus = fmt::format("weights step_N={} force_max_N={}, {} sensors", shortest(study.step_N),
                               shortest(study.force_max_N), bench.sensors);
    row.source = std::move(source);
    row.specimens = loadings;
    row.record_s = levels * (study.hold_s + sensors * static_cast<double>(codes) / rate_Hz);
    row.bench_s = static_cast<double>(loadings) * (row.record_s + study.rest_s);
    samples += static_cast<double>(loadings) * levels * sensors * static_cast<double>(codes);
    e.records += loadings;
    e.rig_s += static_cast<double>(loadings) * row.record_s;
    e.bench_s += row.bench_s;
    e.cases.push_back(std::move(row));
  };
  add("training", study.training, study.dc_samples + study.sine_samples, bench.rate_Hz,
      "Paredes-Madrid 2010, IV");
  e.calibration_bench_s = e.bench_s;
  add("loadings", plan.loadings, plan.frame_samples(), plan.rate_Hz, "Paredes-Madrid 2010, IV");
  e.emulated_cpu_s = samples * kWeightSample_s;
  return e;
}

Result<PlanEstimate> estimate_named_plan(const std::string& name) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(name));
  FORCEGATE_TRY(const bool weights, is_weight_plan(name));
  if (!weights) {
    FORCEGATE_TRY(const Plan plan, read_plan(path));
    PlanEstimate e = estimate_plan(plan);
    FORCEGATE_CHECK_OK(remark_on(plan, e));
    return e;
  }
  FORCEGATE_TRY(const characterize::WeightGatePlan plan, characterize::read_weight_gate_plan(path));
  FORCEGATE_TRY(const auto bench, make_weight_bench("dead_weight", {}));
  return estimate_plan(plan, bench->info());
}

std::string plan_in_words(const PlanEstimate& e, bool with_times, bool notes) {
  std::string out = fmt::format("plan {}: {}, {}, calibration {}, rule {}\n", e.name, counted(e.cases.size(), "case"),
                                counted(e.records, "record"), e.calibration, e.rule_name);
  if (!e.doc.empty()) out += e.doc + "\n";
  for (const PlanEstimateRow& row : e.cases) {
    out += fmt::format("  {:<26} {:<6} x {:<3} {}", row.name, row.loop, row.specimens, row.stimulus);
    if (with_times) out += fmt::format("  | {} each, {} on a bench", hours(row.record_s), hours(row.bench_s));
    out += fmt::format("  [{}]\n", row.source);
  }
  if (with_times)
    out += fmt::format(
        "on a bench {} (of it calibration {}, rests included); emulated {} of rig time, about {} on one "
        "core\n",
        hours(e.bench_s), hours(e.calibration_bench_s), hours(e.rig_s), hours(e.emulated_cpu_s));
  if (with_times && e.looks > 1)
    out += fmt::format("what stays undecided is measured in up to {} sessions: at most {} times as long\n",
                       e.looks, e.looks);
  if (notes)
    for (const std::string& remark : e.remarks) out += "note: " + remark + "\n";
  return out;
}

}  // namespace forcegate
