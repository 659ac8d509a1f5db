#pragma once
// Whether a recording is one of a case's profile: limits are of a profile.

#include <string>

#include "hil/interface/stimulus.h"

namespace forcegate {

/// What differs, in words ("its median force is 1.4 N, the plan's 2.4 N"); "" where nothing does. Compared are the 10, 50 and 90 % quantiles of the
/// force over time, to a tenth of the profile's 90 % and 0.1 N, and how often it crosses its middle while both
/// last, to 15 % and two crossings.
std::string other_profile(const Stimulus& planned, const Stimulus& recorded);

}  // namespace forcegate
