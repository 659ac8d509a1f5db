#include "hil/app/gate/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "hil/app/files/find_plan.h"
#include "hil/app/gate/weight_gate.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/gate/case_result.h"
#include "hil/gate/limits.h"
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

// " for its minima": of which kind of extremum nothing says how far off it may be; empty where nothing is said of either.
std::optional<std::string> without_limit(const Plan& plan, const PlanCase& c, const StimulusFacts& facts, const DerivedLimits& limits) {
  const auto derived = [&](const char* id) { return limits.find(c.name, id).kind != Limit::Kind::none; };
  const bool relative = facts.mean_N - facts.amplitude_N >= plan.limits.minima_floor_N;
  const bool maxima = c.maxima_pct || derived("mre_maxima");
  const bool minima = relative ? c.minima_pct || derived("mre_minima") : derived("mae_minima");
  if (maxima && minima) return std::nullopt;
  return maxima ? fmt::format(" for its minima ({})", relative ? "mre_minima" : "mae_minima") : std::string(minima ? " for its maxima (mre_maxima)" : "");
}

double highest_Hz(const StimulusSpec& spec) {
  double f_Hz = 0.0;
  if (const auto one = spec.numbers.find("f_Hz"); one != spec.numbers.end()) f_Hz = one->second;
  if (const auto many = spec.lists.find("f_Hz"); many != spec.lists.end())
    for (const double f : many->second) f_Hz = std::max(f_Hz, f);
  return f_Hz;
}

// Times that leave nothing to judge, or nothing out: milliseconds where seconds are meant, and the other way round.
void remark_on_times(const Plan& plan, const PlanCase& c, const Stimulus& stimulus, std::vector<std::string>& out) {
  const double f_Hz = highest_Hz(c.stimulus), length_s = stimulus.duration_s();
  if (f_Hz > 0.0 && plan.limits.lag_s >= 0.5 / f_Hz)
    out.push_back(fmt::format("case {}: the lag is never decided, half a period of {:.4g} s is no more than lag_s = {:.4g} s", c.name, 0.5 / f_Hz, plan.limits.lag_s));
  if (c.tail_s <= 0.0 || !(c.checks & (kCheckAccuracy | kCheckPromise))) return;
  if (c.tail_s >= length_s)
    out.push_back(fmt::format("case {}: tail_s = {:.4g} s is no less than the record's {:.4g} s: nothing is left out of it", c.name, c.tail_s, length_s));
  else if (f_Hz > 0.0 && c.tail_s * f_Hz < 2.0)
    out.push_back(fmt::format("case {}: tail_s = {:.4g} s holds fewer than two periods, an accuracy needs two extrema of each kind", c.name, c.tail_s));
}

// What a gate of this plan would stumble over, on the emulated rig at least: no mistake of the file.
Result<void> remark_on(const Plan& plan, PlanEstimate& e) {
  std::vector<std::string>& out = e.remarks;
  const auto refused = [&](std::string why) {
    out.push_back(std::move(why));
    e.refused = true;
  };
  FORCEGATE_TRY(const auto rig, make_rig("emulated", {}));
  const double highest_N = rig->info().force_max_N;
  DerivedLimits limits;
  if (!plan.limits.derived.empty()) {
    const std::filesystem::path path = plan.path.parent_path() / plan.limits.derived;
    if (auto read = read_limits(path))
      limits = std::move(*read);
    else if (std::error_code ignored; std::filesystem::exists(path, ignored))
      refused("limits file " + plan.limits.derived + ": " + read.error().text + " (forcegate limits)");
    else
      out.push_back("limits file " + plan.limits.derived + ": " + read.error().text + " (forcegate limits)");
  }
  const bool with_goldens = std::any_of(plan.cases.begin(), plan.cases.end(), [](const PlanCase& c) { return c.checks & kCheckGolden; });
  if (std::error_code ignored; with_goldens && !std::filesystem::is_directory(plan.path.parent_path() / plan.limits.goldens, ignored))
    out.push_back("golden traces: there is no folder " + (plan.path.parent_path() / plan.limits.goldens).lexically_normal().string() +
                  ", and without a golden there is no decision (forcegate bless RUN makes them)");
  std::set<std::string> specimens;
  for (const PlanCase& c : plan.cases) {
    specimens.insert(specimens_of(plan, c).begin(), specimens_of(plan, c).end());
    const auto made = make_stimulus(c.stimulus);
    if (made && (*made)->facts().maximum_N > highest_N)
      out.push_back(fmt::format("case {} goes to {:.4g} N, the emulated rig to {:.4g} N", c.name, (*made)->facts().maximum_N, highest_N));
    if (c.checks == 0 && plan.name != "campaign") refused("case " + c.name + " asks for no check: forcegate gate refuses it");
    const bool dynamic = made && (*made)->facts().dynamic;
    if (dynamic && c.checks & kCheckAccuracy)
      if (const auto missing = without_limit(plan, c, (*made)->facts(), limits))
        out.push_back("case " + c.name + " asks for an accuracy and has no limit" + *missing + ": maxima_pct, minima_pct and limit_source, or forcegate limits");
    if (dynamic) remark_on_times(plan, c, **made, out);
    if (dynamic && c.checks & kCheckPromise && (*made)->facts().mean_N - (*made)->facts().amplitude_N < plan.limits.minima_floor_N)
      out.push_back(fmt::format("case {} has minima below {:g} N, which have no relative error: the check 'promise' is never decided", c.name, plan.limits.minima_floor_N));
    if (dynamic && c.checks & (kCheckAccuracy | kCheckPromise) && (*made)->duration_s() <= (*made)->facts().excitation_start_s + plan.limits.learning_s)
      out.push_back(fmt::format("case {} ends within the start window of {:.4g} s: no extremum of it is judged", c.name, plan.limits.learning_s));
  }
  if (specimens == std::set<std::string>{kRecorded}) specimens.clear();  // never played on a rig
  for (const std::string& specimen : specimens) {
    RigRecordRequest probe;
    probe.specimen = specimen;
    probe.duration_s = 1.0;
    probe.force_high_N = 1.0;
    if (auto begun = rig->begin(probe); !begun) refused(begun.error().text + (begun.error().hint.empty() ? "" : " (" + begun.error().hint + ")"));
  }
  return {};
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
