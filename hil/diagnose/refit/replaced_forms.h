#pragma once
// A fit takes the form of an effect that the records ask for, whatever the model file writes: who wrote one is told.

#include <string>
#include <vector>

#include "hil/model/model.h"

namespace forcegate::diagnose {

/// One sentence for each effect of both models whose forms are not those of `before`.
std::vector<std::string> replaced_forms(const Model& before, const Model& after);

}  // namespace forcegate::diagnose
