#pragma once
// `forcegate plan`: check a plan, list its cases, estimate its time.

#include <string>
#include <vector>

#include "hil/gate/plan.h"

namespace forcegate {

struct PlanEstimateRow {
  std::string name, loop, stimulus, source;
  std::size_t specimens = 0;
  double record_s = 0.0;  ///< rig time of one record
  double bench_s = 0.0;   ///< all its records with the rests before them, on a real bench
};

struct PlanEstimate {
  std::vector<PlanEstimateRow> cases;
  std::size_t records = 0;
  double calibration_bench_s = 0.0;
  double bench_s = 0.0;         ///< calibration, records and rests, one after the other
  double rig_s = 0.0;           ///< without rests
  double emulated_cpu_s = 0.0;  ///< on one core of this machine's kind, native lane
};

/// `ns_per_sample`: cost of one emulated sample with everything (measured: tests/speed).
PlanEstimate estimate_plan(const Plan& plan, double rate_Hz = 1000.0, double ns_per_sample = 100.0);

/// Table for a person.
std::string plan_in_words(const Plan& plan, const PlanEstimate& estimate, bool with_times);

}  // namespace forcegate
