#pragma once
// Noise and step of the samples of one channel, in its unit.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::diagnose {

/// Robust white noise from fourth differences (1 -4 6 -4 1, norm sqrt 70): smooth signals vanish. Where hardly five samples in a row are there, by
/// noise_between_missing(). 0: too few samples. `most`: so many windows are asked, spread evenly.
double white_noise(const std::vector<double>& x, std::size_t most = 20000);

/// The same where samples are missing again and again: divided differences over five that are there, each at its own place, so that none is made
/// up. What lies further apart than ten samples is no neighbour.
double noise_between_missing(const std::vector<double>& x);

/// The same from what a polynomial through four samples on either side, at their own times, leaves of a sample: a force of ten samples a
/// cycle is smooth to it, and a jittering clock does not make it noise.
double restless_noise(std::span<const double> t_s, const std::vector<double>& x);

/// Fewer than eight: no step can be told from them.
bool shows_few_values(const std::vector<double>& x);

/// Step of the values: the smallest common gap, when nearly all gaps are multiples of it; 0 when none is visible.
double value_step(const std::vector<double>& x);

/// What a converter's step leaves in the mean of many samples with `noise` before it (white, RMS), RMS in the unit of both: without noise step/sqrt 12.
/// Widrow and Kollar 2008, Quantization Noise, 9.4: the mean of a dithered quantiser misses by (step/pi) sum_k (-1)^k/k exp(-2 pi^2 k^2 noise^2/step^2)
/// sin(2 pi k x/step).
double left_of_dithered_step(double step, double noise);

/// Whether F stands at levels that somebody set, weights by hand, and its step is no error of the reading. Asked where it goes a step or more from
/// sample to sample: rounding would be another one each time, and U - a F would scatter by a step/sqrt 12 of it.
bool are_set_levels(const std::vector<double>& F_N, double step_N, const std::vector<double>& U_V, double gain_V_per_N);

}  // namespace forcegate::diagnose
