#pragma once
// Turning points of a cyclic record, and their pairing between channels. The one definition of the
// mean relative error of extrema (Lebosse 2011, eq. 9) and of the RMSE of the maxima (eq. 8).

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace forcegate {

enum class Turn : std::uint8_t { maximum, minimum };

struct Extremum {
  double t_s = 0.0;
  double value = 0.0;
  Turn turn = Turn::maximum;
};

/// Streaming zigzag detector: a turning point is confirmed once the signal has come back by more than
/// `prominence` (same unit as the signal). O(1) a sample, no allocation after construction.
/// NaN samples are skipped and counted by the caller.
class TurningPoints {
 public:
  explicit TurningPoints(double prominence) : prominence_(prominence) {}
  /// True when this sample confirms a turning point, which is then in last().
  bool push(double t_s, double value);
  const Extremum& last() const { return last_; }

 private:
  double prominence_;
  int direction_ = 0;  // 0 unknown, +1 rising, -1 falling
  Extremum high_{}, low_{};
  bool started_ = false;
  Extremum last_{};
};

/// One turning point of the guide channel and what the other channels did in its half-cycle window
/// (from the middle of the preceding half-cycle to the middle of the following one, shifted by `lag`).
struct PairedExtremum {
  Turn turn = Turn::maximum;
  double t_s = 0.0;               ///< instant of the guide's turning point
  double guide = 0.0;             ///< its value
  std::vector<double> value;      ///< one per follower: its extremum in the window, NaN if it has none
  std::vector<double> at_s;       ///< when each follower had it
};

/// Pairs followers' extrema with the guide's while the record streams past. Memory is that of one
/// guide cycle, whatever the record's length. The value of a noisy follower is the mean of the samples
/// within +-`half_width` samples of its extremum, so that the noise does not bias it (a maximum of n noisy samples
/// is too high by 2-3 standard deviations).
class ExtremaPairer {
 public:
  struct Options {
    double prominence = 0.1;     ///< of the guide, its unit
    std::size_t followers = 1;
    int half_width = 0;          ///< averaging half width in samples
    double lag_s = 0.0;          ///< followers' windows are shifted later by this
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
/// error over items and the largest. Items with |expected| < floor are left out and counted.
struct RelativeError {
  double mean = 0.0, standard_error = 0.0, largest = 0.0;
  double mean_absolute = 0.0;   ///< mean |actual - expected| over all finite items, the signal's unit
  std::size_t n = 0, left_out = 0, not_finite = 0;
};
RelativeError mean_relative_error(std::span<const double> actual, std::span<const double> expected,
                                  double floor);

/// Root mean square of measured - model over the items (eq. 8).
double root_mean_square_error(std::span<const double> measured, std::span<const double> model);

}  // namespace forcegate
