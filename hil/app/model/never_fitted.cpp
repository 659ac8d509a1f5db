#include "hil/app/model/never_fitted.h"

#include <algorithm>

#include "hil/base/text.h"
#include "hil/diagnose/candidates/user_candidates.h"

namespace forcegate {
namespace {

bool is_estimated(const ModelParameter& p) { return p.se > 0.0; }

}  // namespace

std::vector<std::string> never_fitted_equations(const Model& model) {
  std::vector<std::string> out;
  for (const UserEffect& e : model.user_effects)
    if (!diagnose::is_fitted(e)) out.push_back(e.name);
  return out;
}

std::vector<std::string> never_fitted_effects(const Model& model) {
  std::vector<std::string> out;
  for (const ModelEffect& e : model.effects)
    if (std::ranges::none_of(e.shape, is_estimated) && std::ranges::none_of(e.strength, is_estimated)) out.push_back(e.effect);
  return out;
}

std::vector<std::string> left_out_notes(const Model& model, const std::string& but) {
  std::vector<std::string> names = never_fitted_equations(model);
  std::erase(names, but);
  if (names.empty()) return {};
  const bool one = names.size() == 1;
  return {join(names, ", ") + (one ? " was" : " were") + " never fitted (no parameter has an se): only the error of the model as written counts " +
          (one ? "it; forcegate add " + names.front() : "them; forcegate add NAME") + " fits " + (one ? "it" : "one of them")};
}

std::vector<std::string> undone_as_written_notes(const Model& model) {
  std::vector<std::string> out;
  for (const std::string& name : never_fitted_equations(model))
    out.push_back(name + " was never fitted (no parameter has an se): the header undoes it with the numbers that are written; forcegate add " + name +
                  " --fit CAMPAIGN fits it, as --fit does here");
  const auto does_nothing = [&](const std::string& name) {
    return std::ranges::all_of(model.effects, [&](const ModelEffect& e) {
      return e.effect != name || std::ranges::all_of(e.strength, [](const ModelParameter& p) { return p.value == 0.0; });
    });
  };
  for (const std::string& name : never_fitted_effects(model))
    if (does_nothing(name)) out.push_back(name + " has no strength in the model file, or one of 0: the header does nothing about it; write one, or --fit CAMPAIGN fits it");
    else out.push_back(name + " is a guess (no parameter has an se): the header undoes it with the numbers that are written; --fit CAMPAIGN fits it");
  return out;
}

}  // namespace forcegate
