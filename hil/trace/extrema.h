#pragma once
// Turning points of a cyclic record, and their pairing between channels. The one definition of the
// mean relative error of extrema (Lebosse 2011, eq. 9) and of the RMSE of the maxima (eq. 8).

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace forcegate {

enum class Turn : std::uint8_t { maximum, minimum };

struct Extremum {
  double t_s = 0.0;  ///< middle of the span over which the extreme value was attained (centre of a plateau)
  double value = 0.0;
  Turn turn = Turn::maximum;
};

/// Streaming zigzag detector: a turning point is confirmed once the signal has come back by more than
/// `prominence` (same unit as the signal) after having moved towards it by more than `prominence`; the first
/// and the last sample of a record are therefore never turning points. O(1) a sample, no allocation.
/// Non-finite samples are skipped; the caller counts them.
class TurningPoints {
 public:
  explicit TurningPoints(double prominence) : prominence_(prominence) {}
  /// True when this sample confirms a turning point, which is then in last(). Maxima and minima alternate.
  bool push(double t_s, double value);
  const Extremum& last() const { return last_; }

 private:
  struct Candidate {
    double value = 0.0, first_s = 0.0, last_s = 0.0;
  };
  static Extremum confirmed(const Candidate& candidate, Turn turn) {
    return {0.5 * (candidate.first_s + candidate.last_s), candidate.value, turn};
  }

  double prominence_;
  int direction_ = 0;  // 0 unknown, +1 rising, -1 falling
  Candidate high_{}, low_{};
  bool started_ = false;
  Extremum last_{};
};

inline bool TurningPoints::push(double t_s, double value) {
  if (!std::isfinite(value)) return false;
  if (!started_) {
    started_ = true;
    high_ = low_ = {value, t_s, t_s};
    return false;
  }
  if (direction_ >= 0) {
    if (value > high_.value)
      high_ = {value, t_s, t_s};
    else if (value == high_.value)
      high_.last_s = t_s;
  }
  if (direction_ <= 0) {
    if (value < low_.value)
      low_ = {value, t_s, t_s};
    else if (value == low_.value)
      low_.last_s = t_s;
  }
  if (direction_ >= 0 && high_.value - value > prominence_) {
    const bool turned = direction_ > 0;
    if (turned) last_ = confirmed(high_, Turn::maximum);
    direction_ = -1;
    low_ = {value, t_s, t_s};
    return turned;
  }
  if (direction_ <= 0 && value - low_.value > prominence_) {
    const bool turned = direction_ < 0;
    if (turned) last_ = confirmed(low_, Turn::minimum);
    direction_ = 1;
    high_ = {value, t_s, t_s};
    return turned;
  }
  return false;
}

/// Those of a series.
std::vector<Extremum> turning_points(std::span<const double> t_s, std::span<const double> value, double prominence);

/// One turning point of the guide channel and what the other channels did in its half-cycle window
/// (from the middle of the preceding half-cycle to the middle of the following one, shifted by `lag`).
struct PairedExtremum {
  Turn turn = Turn::maximum;
  double t_s = 0.0;           ///< instant of the guide's turning point
  double guide = 0.0;         ///< its value
  std::vector<double> value;  ///< one per follower: its extremum in the window, NaN if it has none
  std::vector<double> at_s;   ///< when each follower had it
};

/// Pairs followers' extrema with the guide's while the record streams past. The value of a follower is the
/// extremum of its moving mean over 2 half_width + 1 samples, because the extremum of n noisy samples lies 2-3
/// standard deviations too far out; choose half_width well below an eighth of the shortest cycle. The guide's own
/// value is not averaged: give the quietest channel (the set-point) as guide. Non-finite follower samples are left
/// out of the means. Memory is bounded whatever the record's length: samples older than
/// 65536 are kept as spans of at most 1/256 of their age, so the border of a very long window is exact to 1/256. The first window is cut at the start of
/// the record.
class ExtremaPairer {
 public:
  struct Options {
    double prominence = 0.1;  ///< of the guide, its unit
    std::size_t followers = 1;
    int half_width = 0;  ///< averaging half width in samples
    double lag_s = 0.0;  ///< followers' windows are shifted later by this
  };
  explicit ExtremaPairer(const Options& options);
  ~ExtremaPairer();
  ExtremaPairer(ExtremaPairer&&) noexcept;
  ExtremaPairer& operator=(ExtremaPairer&&) noexcept;

  /// `followers` points to Options::followers values of this instant.
  void push(double t_s, double guide, const double* followers);
  /// Columns at once; follower[k] points to n values.
  void push(std::span<const double> t_s, std::span<const float> guide,
            std::span<const float* const> followers);
  /// Emits what the end of the record still allows (an extremum whose window is complete).
  void finish();

  const std::vector<PairedExtremum>& pairs() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Mean of |actual - expected| / |expected| over the items (eq. 9, in 1, not %), with its standard
/// error over items (NaN below two items) and the largest; the mean |actual - expected| likewise. Items with |expected| < floor are left out of these
/// and counted; items that are not finite on either side are left out of everything and counted. Without any
/// item the means are NaN, never 0.
struct RelativeError {
  double mean = 0.0, standard_error = 0.0, largest = 0.0;
  double mean_absolute = 0.0, standard_error_absolute = 0.0;  ///< |actual - expected| over all finite items, the signal's unit
  std::size_t n = 0, left_out = 0, not_finite = 0;
};
RelativeError mean_relative_error(std::span<const double> actual, std::span<const double> expected,
                                  double floor);

}  // namespace forcegate
