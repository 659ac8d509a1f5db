#pragma once
// Whether a channel moves, or only shows its own noise; and whether one channel follows another.

#include <vector>

namespace forcegate::diagnose {

struct Movement {
  double level = 0.0;      ///< mean
  double noise = 0.0;      ///< white, of a sample
  double excursion = 0.0;  ///< range of what stands out of white noise, at the time scale that shows most of it, less what noise adds; 0: nothing does

  bool stands_out() const { return excursion > 0.0; }
};

/// Means over 1, 2, 4, 8 ... samples are held against the noise that neighbouring samples have: those of white noise scatter by no more than
/// its share, a step of a few samples or a ramp over the record by more at the scale that is its own. What flickers between two or three codes
/// is noise too.
Movement movement_of(const std::vector<double>& x);

/// A bell curve about zero that is white from block to block: noise behind a filter. A force that presses stands on one side of zero.
bool is_noise_that_hangs_together(const std::vector<double>& x);

/// One channel at the samples of another, along straight lines where its clock is another or samples are missing; not finite outside.
std::vector<double> at_times(const std::vector<double>& from_s, const std::vector<double>& y, const std::vector<double>& to_s);

/// Slopes of y against x: by least squares either way, between which the true one lies where both have noise; at_least <= at_most.
struct Response {
  bool found = false;
  double at_least = 0.0, at_most = 0.0;  ///< sizes, without the sign
};

/// Whether y moves when x does. Asked at each time scale of its own, of differences of neighbouring means (Haar), in which two drifts that
/// only happen together are not alike. Samples of the same moments.
Response response_by_scale(const std::vector<double>& x, const std::vector<double>& y);

/// Whether the course of y over the record is that of x: nine tenths of the variance of block means, as they are or beside a cubic in time. Two
/// steady drifts are alike too: the slope must then tell.
Response response_as_a_whole(const std::vector<double>& x, const std::vector<double>& y);

/// The same beside a cubic in time to 99 hundredths, there and back again several times: neither two drifts nor a common disturbance go together
/// so closely.
bool is_one_course(const std::vector<double>& x, const std::vector<double>& y);

/// Means over `blocks` stretches of the samples that both have.
struct Pairs {
  std::vector<double> x, y;
};
Pairs means_of_pairs(const std::vector<double>& x, const std::vector<double>& y, std::size_t blocks);

}  // namespace forcegate::diagnose
