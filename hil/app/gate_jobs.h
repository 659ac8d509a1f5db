#pragma once
// From a plan and a request to the jobs of a run.

#include <string>
#include <vector>

#include "hil/app/gate.h"
#include "hil/gate/case_record.h"

namespace forcegate {

struct GateSetup {
  Plan plan;
  std::string firmware_sha256;
  std::string lane;
  RigInfo rig;
  std::vector<std::string> specimens;  ///< all that are needed, in order of first use
};

/// Checks everything that can be wrong before a record is made (exit 2).
Result<GateSetup> prepare_gate(const GateRequest& request);

/// One per specimen; empty when there is nothing to measure (nominal level, a calibration file, a recording).
std::vector<CaseJob> calibration_jobs(const GateRequest& request, const GateSetup& setup);

/// Every case on each of its specimens, in the plan's order. calibrations: one per specimen of
/// setup.specimens.
std::vector<CaseJob> record_jobs(const GateRequest& request, const GateSetup& setup,
                                 const std::vector<Calibration>& calibrations);

/// Rig time of a job, s.
double rig_time_s(const CaseJob& job);

}  // namespace forcegate
