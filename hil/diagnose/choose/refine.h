#pragma once
// Shapes between the points of the screening grid: each shape of a variant is moved to where the log evidence of the
// whole model is largest, everything else (law, variances, strengths, other effects) following by a linear fit
// (variable projection, Golub and Pereyra 1973).

#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

/// Refines the best variant of a family in spare columns of the channel and adds what that gains to the family's score.
/// `taken` columns stay in the model. False (and nothing changed) when the form has no continuous shape or there is no
/// room left.
bool refine_family(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                   const MixedFit& base, FamilyScore& family, unsigned threads);

/// Families within reach of the best, refined and sorted again; the best stays where its columns are, the room of the
/// others is given back.
void refine_leaders(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                    ScreenResult& result, unsigned threads);

}  // namespace forcegate::diagnose
