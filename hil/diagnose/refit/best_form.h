#pragma once
// The form and the shape of one effect that a refit takes.

#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

/// Best variant of one family beside the columns that are in, its shape refined; fit records only. One that acts between records is chosen as a
/// diagnosis does it, by one number for each record, and all records speak: rows would choose another one than was claimed.
/// Errors (config): the records have no columns of it, and why; or they ask for a strength that it cannot have.
Result<VariantScore> best_form(Workspace& workspace, const std::string& name, const std::vector<int>& present, const MixedFit* warm, unsigned threads);

/// What a model file writes of one effect: its forms beside each other, each shape moved from where the file has it to where it fits best.
struct WrittenForms {
  std::vector<int> variants, columns;
  MixedFit fit;
};

/// `before`: the fit of the `present` columns. nullopt: the library has no such form, no room is left, or the strengths are none that it can have.
std::optional<WrittenForms> written_forms(Workspace& workspace, const std::vector<ModelEffect>& effects, const std::string& name, const std::vector<int>& present,
                                          const MixedFit& before, unsigned threads);

}  // namespace forcegate::diagnose
