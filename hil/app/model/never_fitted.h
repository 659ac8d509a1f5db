#pragma once
// Effects of a model of which no fit has estimated a parameter: what a person wrote down, or what the library guesses.

#include <string>
#include <vector>

#include "hil/model/model.h"

namespace forcegate {

/// No parameter has a standard error. In the order of the model.
std::vector<std::string> never_fitted_equations(const Model& model);
std::vector<std::string> never_fitted_effects(const Model& model);  ///< of the library

/// For compare and fit, which leave such an equation out; `but`: the effect that is just being added. One sentence each.
std::vector<std::string> left_out_notes(const Model& model, const std::string& but = {});

/// For export, which undoes what is written. One sentence each.
std::vector<std::string> undone_as_written_notes(const Model& model);

}  // namespace forcegate
