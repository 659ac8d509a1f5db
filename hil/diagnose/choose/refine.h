#pragma once
// Shapes between the points of the screening grid: each shape of a variant is moved to where the log evidence of the
// whole model is largest, everything else (law, variances, strengths, other effects) following by a linear fit
// (variable projection, Golub and Pereyra 1973).

#include <functional>
#include <vector>

#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

/// From `start` to where gain_at is largest near it: parabolas along each continuous shape's logarithm, within the bounds. Sees every
/// shape that it tries; the last one need not be the best.
void climb(const EffectForm& form, std::vector<double> start, const std::function<double(const std::vector<double>&)>& gain_at);

/// Refines the best variant of a family in spare columns of the channel and adds what that gains to the family's score.
/// `taken` columns stay in the model. False (and nothing changed) when the form has no continuous shape.
bool refine_family(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                   const MixedFit& base, FamilyScore& family, unsigned threads);

/// Lags of films whose cause runs on within records, before the records' levels are asked: a film that is off by half its lag explains little
/// there. Where it hardly runs on the levels tell, and a lag that is fitted to the rows would speak against them.
void refine_films(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present, ScreenResult& result, unsigned threads);

/// Families within reach of the best, refined and sorted again; the best stays where its columns are, the room of the
/// others is given back.
void refine_leaders(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                    ScreenResult& result, unsigned threads);

}  // namespace forcegate::diagnose
