#pragma once
// Two effects of about one size: each hides from the other's records that it has one strength, and neither is a fit alone.

#include <optional>
#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// What a family that was refused for itself agrees beside.
struct Partner {
  ScreenResult beside;    ///< all families beside the refused one
  std::size_t place = 0;  ///< of the partner in it
  ChosenEffect chosen;
};

/// The best family beside the first one that nothing speaks against there, if nothing speaks against the first one beside it either, and if both
/// together take nearly all that is left. Its refined shape stays in the spare columns of the channel where there is one. `taken`: families that do
/// not compete.
std::optional<Partner> partner_of(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                                  const std::vector<std::string>& taken, const ScreenResult& result, const FamilyScore& first,
                                  const SelectionRules& rules, unsigned threads);

}  // namespace forcegate::diagnose
