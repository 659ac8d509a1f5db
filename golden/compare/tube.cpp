#include "golden/compare/tube.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::size_t kChunk = 4096;  // samples a pass; the work arrays stay in the first-level cache

Result<void> refuse_bad_options(const TubeOptions& o, const SampledTrace& golden) {
  const auto bad = [](double v) { return !(v >= 0.0) || std::isinf(v); };
  if (bad(o.absolute) || bad(o.relative) || bad(o.scale) || bad(o.time_s) || !(o.lag_limit_s >= 0.0))
    return fail(ErrorCode::config, "a tube tolerance is negative or not a number", "tube",
                "give absolute, relative, scale, time_s and lag_limit_s as numbers >= 0");
  if (golden.value.empty())
    return fail(ErrorCode::config, "the golden trace is empty", "tube", "record and bless it again");
  if (!(golden.step_s > 0.0))
    return fail(ErrorCode::config, "the golden trace has no sampling step", "tube",
                "record and bless it again");
  return {};
}

std::size_t not_finite(std::span<const float> v) {
  std::size_t n = 0;
  for (const float x : v) n += !std::isfinite(x);
  return n;
}

// Why the two cannot be compared; "" when they can.
std::string coverage_fault(const SampledTrace& g, const SampledTrace& x) {
  if (x.value.empty()) return "the tested trace is empty";
  if (std::fabs(x.step_s - g.step_s) > 1e-9 * g.step_s)
    return fmt::format("the tested trace is sampled every {} s, the golden every {} s", shortest(x.step_s),
                       shortest(g.step_s));
  if (std::fabs(x.t0_s - g.t0_s) > 0.5 * g.step_s)
    return fmt::format("the tested trace starts at {} s, the golden at {} s", shortest(x.t0_s),
                       shortest(g.t0_s));
  if (x.value.size() < g.value.size())
    return fmt::format("the tested trace is truncated: {} of {} samples", x.value.size(), g.value.size());
  if (x.value.size() > g.value.size())
    return fmt::format("the tested trace is longer than the golden: {} instead of {} samples", x.value.size(),
                       g.value.size());
  if (const std::size_t n = not_finite(x.value); n > 0)
    return fmt::format("{} of {} tested samples are not numbers", n, x.value.size());
  return {};
}

// Sliding maximum of hi and minimum of lo over +-h samples for outputs [first, first + n) by van Herk's
// blocks; arrays hold the inputs from first - h on.
struct Window {
  std::vector<double> prefix_max, suffix_max, prefix_min, suffix_min;
  void slide(const std::vector<double>& hi, const std::vector<double>& lo, std::size_t size, std::size_t w) {
    prefix_max.resize(size), suffix_max.resize(size), prefix_min.resize(size), suffix_min.resize(size);
    for (std::size_t b = 0; b < size; b += w) {
      const std::size_t e = std::min(size, b + w);
      prefix_max[b] = hi[b];
      prefix_min[b] = lo[b];
      for (std::size_t i = b + 1; i < e; ++i) {
        prefix_max[i] = std::max(prefix_max[i - 1], hi[i]);
        prefix_min[i] = std::min(prefix_min[i - 1], lo[i]);
      }
      suffix_max[e - 1] = hi[e - 1];
      suffix_min[e - 1] = lo[e - 1];
      for (std::size_t i = e - 1; i-- > b;) {
        suffix_max[i] = std::max(suffix_max[i + 1], hi[i]);
        suffix_min[i] = std::min(suffix_min[i + 1], lo[i]);
      }
    }
  }
};

class Tube {
 public:
  Tube(const SampledTrace& golden, const TubeOptions& o) : g_(golden), o_(o) {
    const auto [low, high] = std::minmax_element(g_.value.begin(), g_.value.end());
    floor_ = std::max(o.absolute, o.scale * (static_cast<double>(*high) - static_cast<double>(*low)));
    const double steps = o.time_s / g_.step_s;
    half_ = static_cast<std::size_t>(steps + 1e-9);
    fraction_ = std::max(0.0, steps - static_cast<double>(half_));
    if (fraction_ < 1e-9) fraction_ = 0.0;
    half_ = std::min(half_, g_.value.size());
  }

  // Edges for samples [first, first + n).
  void edges(std::size_t first, std::size_t n, std::vector<double>& upper, std::vector<double>& lower) {
    const std::size_t reach = half_ + (fraction_ > 0.0 ? 1 : 0);
    const std::size_t from = first >= reach ? first - reach : 0;
    const std::size_t to = std::min(g_.value.size(), first + n + reach);
    const std::size_t size = to - from;
    hi_.resize(size), lo_.resize(size);
    for (std::size_t i = 0; i < size; ++i) {
      const double v = g_.value[from + i];
      const double tol = std::max(floor_, o_.relative * std::fabs(v));
      hi_[i] = v + tol;
      lo_[i] = v - tol;
    }
    upper.resize(n), lower.resize(n);
    if (half_ == 0) {
      std::copy_n(hi_.begin() + static_cast<std::ptrdiff_t>(first - from), n, upper.begin());
      std::copy_n(lo_.begin() + static_cast<std::ptrdiff_t>(first - from), n, lower.begin());
    } else {
      window_.slide(hi_, lo_, size, 2 * half_ + 1);
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t centre = first - from + i;
        const std::size_t a = centre >= half_ ? centre - half_ : 0;
        const std::size_t z = std::min(size - 1, centre + half_);
        // At the ends of the record the window is shorter than van Herk's blocks allow for.
        if (z - a == 2 * half_) {
          upper[i] = std::max(window_.suffix_max[a], window_.prefix_max[z]);
          lower[i] = std::min(window_.suffix_min[a], window_.prefix_min[z]);
        } else {
          upper[i] = *std::max_element(&hi_[a], &hi_[z] + 1);
          lower[i] = *std::min_element(&lo_[a], &lo_[z] + 1);
        }
      }
    }
    if (fraction_ > 0.0) add_interpolated_ends(first - from, n, size, upper, lower);
  }

 private:
  void add_interpolated_ends(std::size_t offset, std::size_t n, std::size_t size, std::vector<double>& upper,
                             std::vector<double>& lower) const {
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t c = offset + i;
      if (c + half_ + 1 < size) {
        const std::size_t k = c + half_;
        upper[i] = std::max(upper[i], hi_[k] + fraction_ * (hi_[k + 1] - hi_[k]));
        lower[i] = std::min(lower[i], lo_[k] + fraction_ * (lo_[k + 1] - lo_[k]));
      }
      if (c >= half_ + 1) {
        const std::size_t k = c - half_;
        upper[i] = std::max(upper[i], hi_[k] + fraction_ * (hi_[k - 1] - hi_[k]));
        lower[i] = std::min(lower[i], lo_[k] + fraction_ * (lo_[k - 1] - lo_[k]));
      }
    }
  }

  const SampledTrace& g_;
  const TubeOptions& o_;
  double floor_ = 0.0;
  std::size_t half_ = 0;
  double fraction_ = 0.0;
  std::vector<double> hi_, lo_;
  Window window_;
};

void note_outside(TubeResult& r, double t_s, double step_s, double margin) {
  ++r.n_outside;
  if (!r.spans.empty() && r.spans.back().to_s + 1.5 * step_s > t_s) {
    r.spans.back().to_s = t_s;
    r.spans.back().worst_margin = std::min(r.spans.back().worst_margin, margin);
    return;
  }
  ++r.spans_in_all;
  if (r.spans.size() < kTubeSpansKept) r.spans.push_back({t_s, t_s, margin});
}

}  // namespace

std::string_view to_string(TubeState state) {
  switch (state) {
    case TubeState::inside: return "inside";
    case TubeState::outside: return "outside";
    case TubeState::not_compared: return "not compared";
  }
  return "not compared";
}

Result<TubeResult> compare_tube(const SampledTrace& golden, const SampledTrace& tested,
                                const TubeOptions& options) {
  FORCEGATE_CHECK_OK(refuse_bad_options(options, golden));
  if (const std::size_t n = not_finite(golden.value); n > 0)
    return fail(ErrorCode::config,
                fmt::format("{} of {} golden samples are not numbers", n, golden.value.size()), "tube",
                "record and bless the golden again");
  TubeResult r;
  r.cause = coverage_fault(golden, tested);
  if (!r.cause.empty()) return r;

  const double record_s = golden.step_s * static_cast<double>(golden.value.size());
  const double search_s =
      std::min(0.25 * record_s, std::max(10.0 * options.time_s, 4.0 * options.lag_limit_s));
  const LagEstimate lag = estimate_lag(golden, tested, search_s);
  r.lag_s = lag.lag_s;
  r.u_lag_s = lag.u_s;
  r.lag_within_limit = !(std::fabs(r.lag_s) > options.lag_limit_s);
  const bool shiftable = options.remove_lag && std::isfinite(r.lag_s);
  const auto shift = shiftable ? static_cast<std::ptrdiff_t>(std::lround(r.lag_s / golden.step_s)) : 0;

  const auto size = static_cast<std::ptrdiff_t>(golden.value.size());
  const auto begin = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(-shift, 0, size));
  const auto end = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(size - shift, 0, size));
  if (end <= begin) {
    r.cause = "no samples are left after the lag was removed";
    return r;
  }
  Tube tube(golden, options);
  std::vector<double> upper, lower, margin;
  if (options.keep_margins) r.margin.assign(golden.value.size(), std::numeric_limits<float>::quiet_NaN());
  r.worst_margin = std::numeric_limits<double>::infinity();
  for (std::size_t first = begin; first < end; first += kChunk) {
    const std::size_t n = std::min(kChunk, end - first);
    tube.edges(first, n, upper, lower);
    const float* x = tested.value.data() + static_cast<std::ptrdiff_t>(first) + shift;
    margin.resize(n);
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
      const double v = x[i];
      margin[i] = std::min(upper[i] - v, v - lower[i]);
      worst = std::min(worst, margin[i]);
    }
    if (worst < r.worst_margin) {
      r.worst_margin = worst;
      const auto at = std::find(margin.begin(), margin.end(), worst) - margin.begin();
      r.worst_at_s = golden.t0_s + golden.step_s * static_cast<double>(first + static_cast<std::size_t>(at));
    }
    if (worst < 0.0)
      for (std::size_t i = 0; i < n; ++i)
        if (margin[i] < 0.0)
          note_outside(r, golden.t0_s + golden.step_s * static_cast<double>(first + i), golden.step_s,
                       margin[i]);
    if (options.keep_margins)
      for (std::size_t i = 0; i < n; ++i) r.margin[first + i] = static_cast<float>(margin[i]);
    r.n += n;
  }
  if (r.n_outside > 0)
    r.cause = fmt::format("{} of {} samples are outside the tube, worst by {:.4g} at {:.3f} s", r.n_outside,
                          r.n, -r.worst_margin, r.worst_at_s);
  else if (!r.lag_within_limit)
    r.cause = fmt::format("the tested trace lags by {:.4g} s, limit {:.4g} s", r.lag_s, options.lag_limit_s);
  r.state = r.n_outside == 0 && r.lag_within_limit ? TubeState::inside : TubeState::outside;
  return r;
}

}  // namespace forcegate
