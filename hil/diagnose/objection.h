#pragma once
// What stands against an effect that the screen puts first.

#include <string>
#include <vector>

#include "hil/diagnose/select.h"

namespace forcegate::diagnose {

/// An effect that the instruments may feign is no answer: what fits worse may still be one.
inline constexpr const char* kTooSmall = "too small for the declared instruments";
inline constexpr const char* kTooLittleEvidence = "too little evidence";
inline constexpr const char* kUnphysical = "its sign is unphysical";
inline constexpr const char* kLeads = "the output leads the reference";

/// The effect may be there although it was refused for this reason.
bool is_suspicion(const std::string& reason);

/// Why an effect is not taken; empty when it is. Sets `stands_out`. `earlier`: what has been chosen before; `removed_before`: RMS that the largest of them removed.
std::string objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family,
                      ChosenEffect& chosen, const std::vector<ChosenEffect>& earlier,
                      double removed_before, const SelectionRules& rules);

}  // namespace forcegate::diagnose
