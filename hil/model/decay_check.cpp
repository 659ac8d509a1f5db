#include "hil/model/decay_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace forcegate {

std::optional<NoDecay> no_decay(const BaseLaw& law, double span_N) {
  constexpr double kFastest_Hz = 25.0;  // a bench drives no faster swing
  if (!law.decays) return std::nullopt;
  const double slowest = law.decay_rate_per_s(0.0), fastest = law.decay_rate_per_s(kFastest_Hz);
  if (slowest < 0.0 || fastest < 0.0)
    return NoDecay{fmt::format("b is {:.3g} 1/s at {:g} Hz: the maxima would grow without end", std::min(slowest, fastest), slowest < fastest ? 0.0 : kFastest_Hz),
                   fmt::format("b_slope_s_per_s f + b_intercept_per_s must not be below 0 from 0 to {:g} Hz; the paper's are 0.0019 and 0.0056", kFastest_Hz),
                   slowest < 0.0 ? std::vector{"b_intercept_per_s", "b_slope_s_per_s"} : std::vector{"b_slope_s_per_s", "b_intercept_per_s"}};
  if (slowest == 0.0 && fastest == 0.0)
    return NoDecay{"b is 0 at every frequency: nothing would decay", "a law without a decay is kind = \"static\"", {"b_intercept_per_s", "b_slope_s_per_s"}};
  const double A_N = 0.5 * span_N, q = law.depth_ratio(A_N);
  if (q > 0.0 && std::isfinite(q)) return std::nullopt;
  return NoDecay{fmt::format("q is {:.3g} at a swing of {:.3g} N, and has to be above 0", q, A_N),
                 fmt::format("q_curvature_per_N2 must be above {:.3g} for a span of {:g} N; the paper's is 1.377", -1.0 / (A_N * A_N), span_N),
                 {"q_curvature_per_N2", "span_N"}};
}

}  // namespace forcegate
