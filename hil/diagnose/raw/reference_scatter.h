#pragma once
// Scatter of the reference beside the output, coloured noise included, which differences of neighbours do not see.

#include <cstddef>
#include <span>

namespace forcegate::diagnose {

/// Of records of less than 4 s, or 8 s, windows are a sixteenth of the record, and 24 samples at least.
/// Standard deviations of F about a parabola over short windows, less what U shows too (a force that really moves moves the output), N.
struct ReferenceScatter {
  double quartile_N = 0.0;  ///< lower quartile over windows of 0.25 s in which F keeps to a tenth of its span; 0: fewer than eight of them
  double alone_N = 0.0;     ///< the same over all windows, less what the noise of U brings into it and cov(F, U) / gain, whichever leaves less
  double still_N = 0.0;  ///< RMS over the windows of 0.5 s in which U stands still, the highest 5 % left out: bursts count; 0: fewer than ten.
                         ///< Movement that U shares is left out by their covariance, which the noise of U does not dilute
  double burst_N = 0.0;        ///< RMS in the windows of 0.25 s in which F is five times as restless as it usually is, and white, while U stands still somewhere
                               ///< above its lowest; 0: these are fewer than five, less than 10 % or more than 60 % of such windows; NaN: fewer than twenty of these
  double between_bursts_N = 0.0;  ///< what is usual there, not below half a step of F
  double burst_share = 0.0;
};
/// `range_V`: span of U over the campaign; it stands still where its standard deviation is below 1 % of that. `gain_V_per_N`: of this record,
/// either sign, not 0. `noise_V`: white noise of a sample of U. `step_N`: of F, 0 where it shows none.
struct OutputFacts {
  double range_V = 1.0, gain_V_per_N = 1.0, noise_V = 0.0, step_N = 0.0;
};
ReferenceScatter reference_scatter(std::span<const double> t_s, std::span<const double> F_N, std::span<const double> U_V, const OutputFacts& output);

/// RMS of the noise that smoothing has left of the reference, N: over the windows, of 0.5 s or of 2 s, in which U stands still, whichever shows
/// more. Noise that hangs together over them is hardly smoothed. 0: too few of them.
double left_where_still(std::span<const double> t_s, std::span<const double> recorded_N, std::span<const double> smoothed_N,
                        std::span<const double> U_V, const OutputFacts& output);

}  // namespace forcegate::diagnose
