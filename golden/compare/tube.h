#pragma once
// Tube comparison of a tested trace with a golden one (docs/trust.md, "What is golden?"). The tube at instant t is
//   upper(t) = max over |s - t| <= time_s of  g(s) + tol(s),   lower(t) = min of g(s) - tol(s),
//   tol(s)   = max(absolute, relative |g(s)|, scale (max g - min g)),
// with g linear between samples, so that a time tolerance that is no multiple of the step is honoured. A
// sample on the edge is inside. There is no hidden constant: zero tolerance means equality.
//
// Coverage is decided before any value: empty, truncated or overlong traces, another clock, and samples
// that are not numbers are NOT COMPARED with the cause, never "inside". A lag is estimated, reported and
// limited on its own; it is taken out before the comparison only when `remove_lag` says so.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct TubeOptions {
  double absolute = 0.0;      ///< unit of the signal, >= 0
  double relative = 0.0;      ///< of |golden|, >= 0
  double scale = 0.0;         ///< of the golden's peak-to-peak, >= 0
  double time_s = 0.0;        ///< half width in time, s, >= 0
  double lag_limit_s = 0.0;   ///< largest |lag| allowed; infinity = reported, not limited
  bool remove_lag = false;    ///< shift the tested trace by the estimated lag, whole samples
  bool keep_margins = false;  ///< fill TubeResult::margin
};

/// Uniformly sampled; value[i] belongs to t0_s + i * step_s.
struct SampledTrace {
  double t0_s = 0.0;
  double step_s = 0.001;
  std::span<const float> value;
};

enum class TubeState { inside, outside, not_compared };
std::string_view to_string(TubeState state);

struct TubeSpan {
  double from_s = 0.0, to_s = 0.0;  ///< first and last sample outside
  double worst_margin = 0.0;        ///< most negative margin in the span
};

struct TubeResult {
  TubeState state = TubeState::not_compared;
  std::string cause;  ///< why not compared, or what is outside; "" when inside
  std::size_t n = 0;  ///< samples compared
  std::size_t n_outside = 0;
  double worst_margin = 0.0;  ///< smallest signed distance to the edge, unit of the signal; < 0 outside
  double worst_at_s = 0.0;
  double lag_s = 0.0;    ///< tested behind golden is positive; NaN when undetermined (constant golden)
  double u_lag_s = 0.0;  ///< standard error over 16 blocks of the record
  bool lag_within_limit = true;
  std::vector<TubeSpan> spans;  ///< runs of samples outside, at most kTubeSpansKept
  std::size_t spans_in_all = 0;
  std::vector<float> margin;  ///< per sample, only with keep_margins
};
inline constexpr std::size_t kTubeSpansKept = 100;

/// O(n), memory O(window) beside the traces. Error (config): negative or non-finite tolerance, a golden that is
/// empty or holds a sample that is not a number.
Result<TubeResult> compare_tube(const SampledTrace& golden, const SampledTrace& tested,
                                const TubeOptions& options);

/// Lag of `tested` behind `golden` by least squares on the golden's slope, refined by whole-sample shifts up to
/// `search_s`; NaN when the golden does not move.
struct LagEstimate {
  double lag_s = 0.0;
  double u_s = 0.0;
};
LagEstimate estimate_lag(const SampledTrace& golden, const SampledTrace& tested, double search_s);

}  // namespace forcegate
