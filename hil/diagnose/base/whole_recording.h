#pragma once
// What one recording shows only once, such as the growth after its one step, no left-out part of it can be foretold from the others. With
// one gain and one zero for all of it, a course that takes the residual from far above the noise down to it is evidence nevertheless.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Whether `fit`, without zetas of the parts, leaves in every part no more than kToItsNoise times the noise.
bool is_down_to_noise(const ResidualChannel& channel, const MixedFit& fit);

/// Whether `fit` describes every part of the recording down to its noise where `base` leaves several times as much, and a free course of
/// time with as many coefficients (half waves over the recording) does not. For a channel whose parts have no gain and zero of their own.
bool describes_whole(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const MixedFit& fit);

/// Whether the whole recording must tell the error of `fit`: it describes it, and what is foretold of left-out parts is far above the noise.
bool whole_must_judge(const Workspace& workspace, const MixedFit& base, const MixedFit& fit);

}  // namespace forcegate::diagnose
