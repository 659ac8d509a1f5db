#include "hil/app/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "hil/base/text.h"
#include "hil/gate/case_result.h"
#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

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
  const double n = static_cast<double>(specimens.size());
  e.calibration_bench_s = n * (record_s + rest_s);
  e.rig_s += n * record_s;
  e.bench_s += e.calibration_bench_s;
  e.emulated_cpu_s = e.rig_s * rate_Hz * ns_per_sample * 1e-9;
  return e;
}

std::string plan_in_words(const Plan& plan, const PlanEstimate& e, bool with_times) {
  std::string out =
      fmt::format("plan {}: {} cases, {} records, calibration {}, rule {}\n", plan.name, plan.cases.size(),
                  e.records, to_string(plan.calibration.level), plan.rule.name);
  if (!plan.doc.empty()) out += plan.doc + "\n";
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
  if (with_times && plan.rule.looks > 1)
    out += fmt::format("what stays undecided is measured in up to {} sessions: at most {} times as long\n",
                       plan.rule.looks, plan.rule.looks);
  return out;
}

}  // namespace forcegate
