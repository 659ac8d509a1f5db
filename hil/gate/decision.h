#pragma once
// From all checks to one decision. A total function: whatever the checks hold (none at all, NaN,
// contradictory verdicts), there is an answer, and it is ACCEPT only if every required check was run, carries
// a finite value inside its limit, and passed.

#include <span>

#include "hil/gate/rule.h"
#include "hil/interface/calibration.h"
#include "hil/interface/check.h"

namespace forcegate {

/// What happened besides the checks.
struct RunEvents {
  bool cancelled = false;
  bool harness_error = false;  ///< a defect of ours: exit 6
  std::string harness_text;
  bool safety_stop = false;          ///< some record was stopped for safety
  bool safety_cause_decided = true;  ///< false: exit 5
  std::string safety_text;
  CalibrationLevel level = CalibrationLevel::identified;
  bool calibration_given = false;  ///< by a file: nothing in the run tells whose it is
  bool of_recording = false;  ///< played again it is the same: no rig error of it is exit 4, and nobody mends a link or a rig
};

/// Order of precedence: cancelled, harness error, REJECT, safety stop of undecided cause, rig error, any
/// other reason for NO-DECISION, ACCEPT. Exit codes as in docs/gate.md.
Decision decide(std::span<const Check* const> checks, const DecisionRule& rule, const RunEvents& events);

/// "mean relative error of the maxima 11.7(4) % > 4.5 % (Lebosse 2011, IV-B2)"
std::string check_in_words(const Check& check);

}  // namespace forcegate
