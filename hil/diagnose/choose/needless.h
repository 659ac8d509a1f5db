#pragma once
// S5, backward: an earlier effect may have been a compromise that the later ones make needless.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Takes out, and lists as refused, what the other effects do without; sets `unique` of those that stay and, where one went, fits the rest
/// anew. A look-alike gets all forms of its family before it is said that it cannot do without the other. What changes from record to record
/// makes nothing needless that happens within one, and stays itself where the records' gains and zeros bear it. `carried`: columns that
/// belong to the model whatever is chosen.
void drop_needless(const ResidualChannel& channel, const std::vector<int>& carried, const SelectionRules& rules, Selection& out);

}  // namespace forcegate::diagnose
