#pragma once
// From what was measured to the result, for every kind of gate: golden traces, the checks with their rule, waivers, the
// decision. The same for a run that has just been played and for a stored one.

#include <string>
#include <vector>

#include "hil/app/gate/gate.h"
#include "hil/app/gate/golden.h"
#include "hil/gate/waiver.h"

namespace forcegate {

/// What a decision follows from besides the records.
struct RunEvidence {
  std::vector<GoldenRecord> goldens;
  std::vector<Waiver> waivers;
  std::string today;  ///< ISO date against which waivers expire
};

/// Errors (usage): a day that is none; "" is the calendar's.
Result<void> check_day(const std::string& today);

/// Goldens (folder as seen from the plan's file; empty: none) and waivers of a request.
/// Errors: usage (a day that is none), those of the files.
Result<RunEvidence> read_evidence(const GateRequest& request, const std::filesystem::path& plan,
                                  const std::string& goldens);

/// `Material` is RunMaterial or characterize::WeightMaterial. notes: of goldens and waivers; may be material.head.notes.
template <class Material>
RunResult judged_run(Material& material, const RunEvidence& evidence, std::vector<std::string>& notes,
                     std::vector<GoldenMargins>* margins = nullptr) {
  const ChecksByRecord others = golden_checks(golden_targets(material), evidence.goldens, notes, margins);
  std::vector<JudgedCheck> of_run = judge_material(material, others);
  apply_waivers(evidence.waivers, evidence.today, of_run, all_checks(of_run, material.records), notes);
  return to_run_result(material, of_run);
}

}  // namespace forcegate
