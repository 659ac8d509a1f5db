#pragma once
// What stands against an effect that the screen puts first.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Effects that bend the output over the force. A loop that is wider at one end of the force than at the other has such a curve of its own.
bool is_curve(const std::string& effect);

struct Objection {
  Refusal why = Refusal::none;
  bool stands_out = false;  ///< taken although it leaves most: far above all else, across what was chosen before, of one strength
};

/// Why an effect is not taken. `earlier`: what has been chosen before; `removed_before`: RMS that the largest of them removed, 0: nothing has.
Objection objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family, const ChosenEffect& chosen,
                    const std::vector<ChosenEffect>& earlier, double removed_before, const SelectionRules& rules);

}  // namespace forcegate::diagnose
