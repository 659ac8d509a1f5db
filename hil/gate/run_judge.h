#pragma once
// From the records of a run to its result: every record judged, the panel, one decision rule over all checks, the
// decision. A pure function of what was measured: a stored run is judged again in the same way, under the same or
// under other limits.

#include <map>
#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/judge.h"
#include "hil/gate/limits.h"
#include "hil/gate/plan.h"
#include "hil/interface/run_result.h"

namespace forcegate {

struct PlayedRecord {
  std::size_t case_index = 0, specimen_index = 0;  ///< in the plan and in the case's list of specimens
  CaseJob job;
  CaseRecord record;
  JudgedCase judged;
  bool superseded = false;  ///< the rig was at fault and a later attempt stands for it
};

/// All that a result follows from.
struct RunMaterial {
  Plan plan;
  DerivedLimits limits;
  CalibrationLevel level = CalibrationLevel::nominal;
  bool cancelled = false;
  std::vector<PlayedRecord> records;  ///< in the order in which they were played
  std::vector<JudgedCheck> compared;  ///< against the accepted build; still to be judged
  RunResult head;                     ///< what is not judged: names, hashes, versions, notes
};

/// Checks that others made of a record (golden traces), by place of the record; they take part in the decision rule.
using ChecksByRecord = std::map<std::size_t, std::vector<JudgedCheck>>;

/// Where one of a record's checks found the rig at fault, what is still to be judged becomes rig_error with its blame;
/// arithmetic on the same codes ("conformance") stays judged. Returns that check, or null.
const Check* charge_rig(std::vector<JudgedCheck>& checks);

/// Judges every record anew (PlayedRecord::judged) and returns the checks of the whole run; the decision rule has run over
/// all of them together.
std::vector<JudgedCheck> judge_records(const Plan& plan, const DerivedLimits& limits,
                                       std::vector<PlayedRecord>& records, const ChecksByRecord& others = {});

/// Checks "no_worse_*/CASE" among `of_run`: where a record of the case was spoiled by its rig, or is no whole one, they say so and
/// are not judged.
void charge_compared(const Plan& plan, const std::vector<PlayedRecord>& records, std::vector<JudgedCheck>& of_run);

/// The same of a whole run, with what was compared.
std::vector<JudgedCheck> judge_material(RunMaterial& material, const ChecksByRecord& others = {});

/// Those of the run and of every record that is not superseded.
std::vector<JudgedCheck*> all_checks(std::vector<JudgedCheck>& of_run, std::vector<PlayedRecord>& records);

/// The result with its decision, cases in the plan's order, sessions and attempts of one record after each other. Curves
/// and extrema of a record stay in only where its job has `curves`.
RunResult to_run_result(const RunMaterial& material, const std::vector<JudgedCheck>& of_run);

/// An attempt that the rig spoiled and a later one stands for. Its note tells that, while that of any other case is why it has no record.
bool is_superseded(const CaseResult& result);

}  // namespace forcegate
