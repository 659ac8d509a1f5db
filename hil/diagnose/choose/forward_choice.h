#pragma once
// Forward choice: one family after the other, each beside those that were taken. What two clocks and a late reference may do is carried along
// and is no finding.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

struct ForwardChosen {
  Selection selection;
  std::vector<int> carried;  ///< columns of the model, what its families soak up, and what is left to the clocks
  bool leads = false;        ///< a late reference is among them: what is late beside it repairs its smoothing
};
ForwardChosen choose_forward(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                             const SelectionRules& rules, unsigned threads);

}  // namespace forcegate::diagnose
