#pragma once
// S5: what was chosen first was chosen while the others were still in the residual; it is chosen once more beside them.

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// Every effect within records that had rivals competes with them again, over a model with the other chosen effects in it: shares are set
/// anew, the form too, and a rival that now explains more, and that nothing speaks against, takes the place; the model is fitted anew where anything changed. `carried`: columns that
/// belong to the model whatever is chosen.
void reconsider(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& carried, const std::vector<std::string>& skip,
                const SelectionRules& rules, unsigned threads, Selection& out);

}  // namespace forcegate::diagnose
