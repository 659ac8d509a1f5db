#pragma once
// The part of a case that goes into the result of the run.

#include "hil/gate/judge.h"
#include "hil/interface/run_result.h"
#include "hil/trace/decay_fit.h"

namespace forcegate {

/// Curves and extrema are left out of a record that passed unless with_curves says that it stands for its
/// case: a nightly has hundreds of records.
CaseResult to_case_result(const PlanCase& planned, const CaseJob& job, CaseRecord record,
                          const JudgedCase& judged, bool with_curves);

/// Decay for the result: eq. (3) as fitted, over U_min, and the share of the swing that is lost at `until_s`.
DecayFit to_decay_fit(const DecayParameters& fit, double u_min_V, double until_s);

/// "sine A_N=1.05 f_Hz=0.5 m_N=2.15"
std::string stimulus_in_words(const StimulusSpec& spec);

}  // namespace forcegate
