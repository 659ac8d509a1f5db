#pragma once
// An angle that is the way of a spindle, F = a + k theta, and not the angle of a wheel, F = k (preload + eccentricity (1 - cos theta)).

#include "hil/model/record_input.h"

namespace forcegate {

/// Whether the force goes with the angle itself: in some record over more than half a turn, where that of a wheel would come back, and in most of those
/// that move along a line that leaves less than half of what the wheel's law leaves; or over 1.5 rad along a line that leaves 1 % (RMS), which no part of a
/// turn of a wheel does. Not where an eccentricity is declared.
bool is_spindle(const CampaignInput& campaign);

/// Then takes the wheel's channels out of the records (their theta_rad stays), sets has_spindle instead of has_theta and notes it.
void take_spindle(CampaignInput& campaign);

}  // namespace forcegate
