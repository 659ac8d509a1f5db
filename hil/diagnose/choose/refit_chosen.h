#pragma once
// S5: the model of a choice that was changed behind the forward search.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Fits the chosen effects anew, one beside the other in their order: `fit` of each, and `final` with all forms of their families, from which
/// everything that judges the remainder reads. `carried`: columns that belong to the model whatever is chosen. Nothing changes from the
/// effect on whose model cannot be fitted.
void refit_chosen(const ResidualChannel& channel, const std::vector<int>& carried, Selection& selection);

/// Columns of the claimed model without those of one of its effects.
std::vector<int> columns_beside(const ResidualChannel& channel, const Selection& selection, const ChosenEffect& effect);

}  // namespace forcegate::diagnose
