#pragma once
// The reference as a regressor: its noise bends, delays and loops everything that is regressed on it (errors in
// variables). Each sample is replaced by the centre of a local parabola over the widest window that its own noise
// allows, so that no candidate gains by smoothing alone.
//
// Windows 2m+1, m = 2, 4 ... 32, least-squares parabola (Savitzky and Golay 1964); the widest m whose estimate still
// agrees with all narrower ones within some standard deviations (intersection of confidence intervals, Goldenshluger and
// Nemirovski 1997). Symmetric: no shift, and no bias up to the cube of time. What a force that turns quickly loses is of the size of what
// agrees, and the same in every cycle.

#include <vector>

namespace forcegate::diagnose {

/// Standard deviations within which windows agree, where the force moves no quicker than the widest can follow.
inline constexpr double kAgree = 1.7;

/// sigma: standard deviation of the noise of one sample, steps included. Samples next to missing ones stay as they are. `left`: RMS of the
/// noise that the samples are left with, were it white; it hangs together over the windows.
std::vector<double> smooth_within_noise(std::vector<double> x, double sigma, double* left = nullptr, double agree = kAgree);

}  // namespace forcegate::diagnose
