#pragma once
// `forcegate plan`: check a plan, list its cases, estimate its time.

#include <string>
#include <vector>

#include "hil/characterize/capacitance/weight_gate.h"
#include "hil/gate/plan.h"

namespace forcegate {

struct PlanEstimateRow {
  std::string name, loop, stimulus, source;
  std::size_t specimens = 0;  ///< records of it
  double record_s = 0.0;      ///< rig time of one record
  double bench_s = 0.0;       ///< all its records with the rests before them, on a real bench
};

struct PlanEstimate {
  std::string name, doc, sha256, calibration, rule_name, rule;
  int looks = 1;
  bool weights = false;  ///< a plan of kind capacitance-gate
  bool replays = false;  ///< its cases are a recording, which no rig makes
  std::vector<PlanEstimateRow> cases;
  std::vector<std::string> remarks;  ///< what a gate would stumble over although the file is right
  bool refused = false;              ///< one of them ends a gate with exit 2
  std::size_t records = 0;
  double calibration_bench_s = 0.0;
  double bench_s = 0.0;         ///< calibration, records and rests, one after the other
  double rig_s = 0.0;           ///< without rests
  double emulated_cpu_s = 0.0;  ///< on one core of this machine's kind, native lane
};

/// `ns_per_sample`: cost of one emulated sample with everything (measured: tests/speed).
PlanEstimate estimate_plan(const Plan& plan, double rate_Hz = 1000.0, double ns_per_sample = 100.0);

/// Of a gate of conductance and capacitance: the loadings of its training and its own, all sensors of the pack under the
/// same weights. `bench`: sensors, and the converter's rate for the training.
PlanEstimate estimate_plan(const characterize::WeightGatePlan& plan, const WeightBenchInfo& bench);

/// Plan of either kind, with the emulated bench's sensors and rate, and remarks on one of cases. Errors: those of the plan.
Result<PlanEstimate> estimate_named_plan(const std::string& name);

/// Table for a person.
std::string plan_in_words(const PlanEstimate& estimate, bool with_times, bool notes = true);

}  // namespace forcegate
