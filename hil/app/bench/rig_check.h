#pragma once
// `forcegate bench selfcheck` and `forcegate bench repeatability`: is this rig fit to judge a build?

#include "hil/app/bench/rig_history.h"
#include "hil/app/gate/gate.h"
#include "hil/gate/limits.h"

namespace forcegate {

struct SelfcheckRequest {
  GateRequest gate;               ///< known-good firmware, plan "selfcheck", rig; its result is the evidence
  std::filesystem::path history;  ///< empty: none is kept
};

struct SelfcheckAnswer {
  RunResult result;                  ///< the known-good build on the known profile
  std::vector<ControlChart> charts;  ///< with a history
  std::size_t visits = 0;            ///< that are charted, with this one
  std::size_t left_out = 0;          ///< others of this rig (charted_visits)
  bool fit = false;
  std::vector<std::string> reasons;  ///< why not
};

/// fit: the rig's checks passed, the known-good build was accepted, no chart is out of control. A visit that found the rig
/// unfit is kept in the history too.
Result<SelfcheckAnswer> selfcheck(const SelfcheckRequest& request, const GateProgress& progress = {},
                                  const std::atomic<bool>* cancelled = nullptr);
std::string selfcheck_text(const SelfcheckAnswer& answer);
std::string selfcheck_json(const SelfcheckAnswer& answer);

struct RepeatabilityRequest {
  GateRequest gate;    ///< known-good firmware, plan, rig
  std::size_t n = 20;  ///< runs, each with the next seed; on a real rig simply again
  std::string date;    ///< for the limits file
};

/// How one judged error of one case varies when nothing is changed.
struct CheckRepeatability {
  std::string case_name, check_id, unit;
  std::size_t n = 0;
  double mean = 0.0, s = 0.0, largest = 0.0;
  double plan_limit = 0.0;  ///< that the plan gives itself; NaN when none
  double gauge_pct = 0.0;   ///< of the plan's limit, else of the derived one
  bool resolved = false;    ///< gauge_pct <= kGaugeRefused_pct
};

struct RepeatabilityAnswer {
  std::vector<CheckRepeatability> rows;
  DerivedLimits limits;  ///< only of what the rig resolves; n, date, rig id
};

Result<RepeatabilityAnswer> repeatability(const RepeatabilityRequest& request,
                                          const GateProgress& progress = {},
                                          const std::atomic<bool>* cancelled = nullptr);
std::string repeatability_text(const RepeatabilityAnswer& answer);
std::string repeatability_json(const RepeatabilityAnswer& answer);

}  // namespace forcegate
