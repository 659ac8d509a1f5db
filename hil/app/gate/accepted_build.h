#pragma once
// The build that the candidate must not be worse than: an image that is played in turn with it, or a stored
// run.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "hil/app/gate/gate.h"
#include "hil/app/gate/gate_jobs.h"
#include "hil/gate/limits.h"
#include "hil/gate/no_worse.h"

namespace forcegate {

struct AcceptedBuild {
  std::string path, sha256;
  bool stored = false;
  RunResult run;                              ///< of a stored one
  std::map<std::string, CaseRecord> records;  ///< of its bundle by their id, without any it is compared by its values
};

/// Opens GateRequest::accepted. `head` names plan, seed, rig and conditions of the run; `setup` is null under weights. Errors (usage): no such file, neither an image
/// that a lane can run nor a result.json, a stored run under other conditions (same_conditions.h).
Result<AcceptedBuild> open_accepted(const GateRequest& request, const GateSetup* setup, const RunResult& head);

/// Lane for the accepted image: that of the candidate where it accepts it, else the first that does.
std::string accepted_lane(const std::string& own, const AcceptedBuild& build);

/// For the notes of a result; of a stored run that is no ACCEPT, that too.
std::string accepted_note(const AcceptedBuild& build);

/// The same record for the accepted image.
CaseJob accepted_job(const CaseJob& job, const AcceptedBuild& build);

/// A record of the candidate and what it is compared with.
struct ComparedRecord {
  const PlanCase* planned = nullptr;
  const CaseRecord* candidate = nullptr;
  const CaseRecord* accepted = nullptr;              ///< of the accepted image; null when it is a stored run
  const std::vector<JudgedCheck>* judged = nullptr;  ///< of the candidate
};

/// Checks of the whole run, one of maxima and one of minima for each case; the decision rule is still to be
/// applied. Sessions that a stored run did not have are left out: it has a first one of every record.
std::vector<JudgedCheck> compare_with_accepted(const Plan& plan, const DerivedLimits& limits, const AcceptedBuild& build, bool rig_repeats,
                                               std::span<const ComparedRecord> pairs);

}  // namespace forcegate
