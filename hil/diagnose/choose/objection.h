#pragma once
// What stands against an effect that the screen puts first.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Effects that bend the output over the force. A loop that is wider at one end of the force than at the other has such a curve of its own.
bool is_curve(const std::string& effect);

/// Why an effect is not taken. Sets `stands_out`. `earlier`: what has been chosen before; `removed_before`: RMS that the largest of them removed.
Refusal objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family,
                      ChosenEffect& chosen, const std::vector<ChosenEffect>& earlier,
                      double removed_before, const SelectionRules& rules);

}  // namespace forcegate::diagnose
