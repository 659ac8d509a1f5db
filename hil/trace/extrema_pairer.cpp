#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Samples are looked after in groups of this many, counted from the start of the record, so that the result does
// not depend on the size of the caller's blocks.
constexpr std::size_t kGroup = 256;
// Above the limit, half of it is condensed to spans; older spans are joined up to 1/256 of their age.
constexpr std::size_t kFullRateLimit = 65536;
constexpr std::size_t kFirstSpan = 128;
constexpr std::size_t kStretch = 64;
constexpr std::uint64_t kSpansPerAge = 256;

/// Extreme of one follower in one direction, with the span over which it was attained.
struct Extreme {
  double value = -kInfinity, first_s = kNone, last_s = kNone;

  void add(const Extreme& later) {
    if (later.value > value)
      *this = later;
    else if (later.value == value)
      last_s = later.last_s;
  }
};

struct Extremes {
  Extreme high, low;  ///< low holds the negated values, so that both are maxima

  void add(const Extremes& later) {
    high.add(later.high);
    low.add(later.low);
  }
};

struct Span {
  double first_s = 0.0, last_s = 0.0;
  std::uint64_t end = 0;  ///< sample number one past its last
  std::uint64_t n = 0;
};

struct Window {
  Extremum turn;
  double from_s = 0.0, to_s = kInfinity;
};

/// Largest of sign * x; NaN compares false and is left out. Four lanes, because a max waits for its predecessor.
double largest(const double* x, std::size_t n, double sign) {
  double lane[4] = {-kInfinity, -kInfinity, -kInfinity, -kInfinity};
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t k = 0; k < 4; ++k) lane[k] = sign * x[i + k] > lane[k] ? sign * x[i + k] : lane[k];
  for (; i < n; ++i) lane[0] = sign * x[i] > lane[0] ? sign * x[i] : lane[0];
  return std::max(std::max(lane[0], lane[1]), std::max(lane[2], lane[3]));
}

Extreme extreme(const double* x, const double* t_s, std::size_t n, double sign) {
  Extreme e;
  e.value = largest(x, n, sign);
  if (!std::isfinite(e.value)) return {};
  std::size_t first = 0, last = n - 1;
  while (sign * x[first] != e.value) ++first;
  while (sign * x[last] != e.value) --last;
  e.first_s = t_s[first];
  e.last_s = t_s[last];
  return e;
}

}  // namespace

struct ExtremaPairer::Impl {
  explicit Impl(const Options& o)
      : options(o),
        half_width(static_cast<std::size_t>(std::max(0, o.half_width))),
        turning(o.prominence),
        x(o.followers) {}

  void push(double t_s, double guide, const double* followers) {
    t.push_back(t_s);
    for (std::size_t k = 0; k < x.size(); ++k) x[k].push_back(followers[k]);
    if (turning.push(t_s, guide)) turned(turning.last());
    if ((base + t.size()) % kGroup == 0) look_after();
  }

  void push(std::span<const double> t_s, std::span<const float> guide,
            std::span<const float* const> followers) {
    for (std::size_t at = 0; at < t_s.size();) {
      const std::size_t n =
          std::min(t_s.size() - at, kGroup - static_cast<std::size_t>((base + t.size()) % kGroup));
      t.insert(t.end(), t_s.begin() + static_cast<std::ptrdiff_t>(at),
               t_s.begin() + static_cast<std::ptrdiff_t>(at + n));
      for (std::size_t k = 0; k < x.size(); ++k) {
        const std::size_t old = x[k].size();
        x[k].resize(old + n);
        double* to = x[k].data() + old;
        const float* source = followers[k] + at;
        for (std::size_t i = 0; i < n; ++i) to[i] = source[i];
      }
      for (std::size_t i = at; i < at + n; ++i)
        if (turning.push(t_s[i], guide[i])) turned(turning.last());
      at += n;
      if ((base + t.size()) % kGroup == 0) look_after();
    }
  }

  void turned(const Extremum& turn) {
    Window window{turn, record_start_s(), kInfinity};
    if (has_previous) {
      const double middle_s = 0.5 * (previous.t_s + turn.t_s) + options.lag_s;
      window.from_s = middle_s;
      waiting.back().to_s = middle_s;
      if (first_open) {
        waiting.back().from_s =
            std::max(record_start_s(), previous.t_s + options.lag_s - 0.5 * (turn.t_s - previous.t_s));
        first_open = false;
      }
    }
    waiting.push_back(window);
    previous = turn;
    has_previous = true;
  }

  double record_start_s() const { return base == 0 && !t.empty() ? t.front() : start_s; }

  void look_after() {
    if (base == 0) start_s = t.front();
    const double complete_s = t.size() > half_width ? t[t.size() - 1 - half_width] : -kInfinity;
    std::size_t done = 0;
    while (done < waiting.size() && waiting[done].to_s < complete_s) emit(waiting[done++]);
    if (done > 0) {
      waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(done));
      forget_before(waiting.front().from_s);  // the youngest window always stays open
    }
    if (t.size() > kFullRateLimit) condense();
  }

  void forget_before(double from_s) {
    const auto old =
        std::find_if(spans.begin(), spans.end(), [&](const Span& s) { return s.last_s >= from_s; });
    const auto n = old - spans.begin();
    spans.erase(spans.begin(), old);
    extremes.erase(extremes.begin(), extremes.begin() + n * static_cast<std::ptrdiff_t>(x.size()));
    const auto at = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), from_s) - t.begin());
    if (at > half_width) drop(at - half_width);
  }

  void drop(std::size_t n) {
    const auto count = static_cast<std::ptrdiff_t>(n);
    t.erase(t.begin(), t.begin() + count);
    for (auto& column : x) column.erase(column.begin(), column.begin() + count);
    base += n;
    kept_before = kept_before > n ? kept_before - n : 0;
  }

  /// Moving means that belong to samples [from, to) of one follower; the neighbours beyond the ends of what is kept
  /// do not exist. Points into the column itself when there is nothing to average.
  const double* smooth(std::size_t k, std::size_t from, std::size_t to) {
    if (half_width == 0) return x[k].data() + from;
    const std::size_t first = from > half_width ? from - half_width : 0;
    const std::size_t last = std::min(t.size(), to + half_width);
    const double* column = x[k].data() + first;
    prefix.resize(last - first + 1);
    smoothed.resize(to - from);
    double sum = 0.0;
    for (std::size_t i = 0; i < last - first; ++i) {
      prefix[i] = sum;
      sum += column[i];
    }
    prefix[last - first] = sum;
    const bool all_finite = std::isfinite(sum);
    const double* column_0 = x[k].data();
    const auto mean_at = [&](std::size_t i) {
      const std::size_t a = i > half_width ? i - half_width : 0, b = std::min(t.size(), i + half_width + 1);
      if (all_finite) return (prefix[b - first] - prefix[a - first]) / static_cast<double>(b - a);
      double finite_sum = 0.0;
      std::size_t count = 0;
      for (std::size_t j = a; j < b; ++j)
        if (std::isfinite(column_0[j])) finite_sum += column_0[j], ++count;
      return count > 0 ? finite_sum / static_cast<double>(count) : kNone;
    };
    const std::size_t inner = std::min(to, std::max(from, half_width));
    const std::size_t inner_end = std::max(inner, std::min(to, t.size() - std::min(t.size(), half_width)));
    for (std::size_t i = from; i < inner; ++i) smoothed[i - from] = mean_at(i);
    if (all_finite) {
      const double* low = prefix.data() + (inner - std::min(inner, half_width) - first);
      const double* high = low + 2 * half_width + 1;
      const double scale = 1.0 / static_cast<double>(2 * half_width + 1);
      for (std::size_t i = inner; i < inner_end; ++i)
        smoothed[i - from] = (high[i - inner] - low[i - inner]) * scale;
    } else {
      for (std::size_t i = inner; i < inner_end; ++i) smoothed[i - from] = mean_at(i);
    }
    for (std::size_t i = inner_end; i < to; ++i) smoothed[i - from] = mean_at(i);
    return smoothed.data();
  }

  /// Extreme of the moving means of samples [from, to). No mean exceeds the largest of its samples: stretches whose
  /// largest sample lies below a mean that is known already are passed over.
  Extreme extreme_of_means(std::size_t k, std::size_t from, std::size_t to, double sign) {
    if (half_width == 0 || to - from < 4 * kStretch)
      return extreme(smooth(k, from, to), t.data() + from, to - from, sign);
    double known = -kInfinity;
    for (std::size_t i = from; i < to; i += kStretch / 2)
      known = std::max(known, largest(smooth(k, i, i + 1), 1, sign));
    known -= 1e-9 * std::fabs(known);
    Extreme found;
    for (std::size_t a = from; a < to; a += kStretch) {
      const std::size_t b = std::min(to, a + kStretch);
      const std::size_t first = a > half_width ? a - half_width : 0,
                        last = std::min(t.size(), b + half_width);
      if (largest(x[k].data() + first, last - first, sign) < known) continue;
      found.add(extreme(smooth(k, a, b), t.data() + a, b - a, sign));
    }
    return found;
  }

  void condense() {
    const std::size_t n = kFullRateLimit / 2 + kept_before;
    for (std::size_t from = kept_before; from < n; from += kFirstSpan) {
      const std::size_t to = std::min(n, from + kFirstSpan);
      spans.push_back({t[from], t[to - 1], base + to, to - from});
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double* values = smooth(k, from, to);
        extremes.push_back(
            {extreme(values, &t[from], to - from, 1.0), extreme(values, &t[from], to - from, -1.0)});
      }
    }
    // the last half_width condensed samples stay as neighbours of the next
    drop(n - half_width);
    kept_before = half_width;
    join_old_spans();
  }

  void join_old_spans() {
    const std::size_t followers = x.size();
    const std::uint64_t now = base + t.size();
    std::size_t to = 0;
    for (std::size_t from = 0; from < spans.size(); ++from) {
      if (to > 0 && (spans[to - 1].n + spans[from].n) * kSpansPerAge <= now - spans[from].end) {
        spans[to - 1].last_s = spans[from].last_s;
        spans[to - 1].end = spans[from].end;
        spans[to - 1].n += spans[from].n;
        for (std::size_t k = 0; k < followers; ++k)
          extremes[(to - 1) * followers + k].add(extremes[from * followers + k]);
        continue;
      }
      spans[to] = spans[from];
      for (std::size_t k = 0; k < followers; ++k)
        extremes[to * followers + k] = extremes[from * followers + k];
      ++to;
    }
    spans.resize(to);
    extremes.resize(to * followers);
  }

  void emit(const Window& window) {
    const bool maximum = window.turn.turn == Turn::maximum;
    const double sign = maximum ? 1.0 : -1.0;
    auto from = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), window.from_s) - t.begin());
    const auto to = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), window.to_s) - t.begin());
    from = std::max(from, kept_before);

    PairedExtremum pair;
    pair.turn = window.turn.turn;
    pair.t_s = window.turn.t_s;
    pair.guide = window.turn.value;
    for (std::size_t k = 0; k < x.size(); ++k) {
      Extreme found;
      for (std::size_t s = 0; s < spans.size() && spans[s].first_s <= window.to_s; ++s) {
        if (spans[s].last_s < window.from_s) continue;
        const Extremes& e = extremes[s * x.size() + k];
        found.add(maximum ? e.high : e.low);
      }
      if (from < to) found.add(extreme_of_means(k, from, to, sign));
      const bool any = std::isfinite(found.value);
      pair.value.push_back(any ? sign * found.value : kNone);
      pair.at_s.push_back(any ? 0.5 * (found.first_s + found.last_s) : kNone);
    }
    pairs.push_back(std::move(pair));
  }

  void finish() {
    if (finished || waiting.empty()) return;
    finished = true;
    // The last turning point has no successor: its window is as long after it as before it.
    Window& last = waiting.back();
    const double before_s = last.turn.t_s + options.lag_s - last.from_s;
    last.to_s = last.turn.t_s + options.lag_s + before_s;
    const double step_s = t.size() > 1 ? t[t.size() - 1] - t[t.size() - 2] : 0.0;
    for (const Window& window : waiting)
      if (window.to_s <= t.back() + 0.5 * step_s) emit(window);
    waiting.clear();
  }

  Options options;
  std::size_t half_width;
  TurningPoints turning;

  // Full-rate samples from number `base` on. The first `kept_before` of them are in `spans` already and serve only
  // as neighbours of the moving mean.
  std::vector<double> t;
  std::vector<std::vector<double>> x;
  std::uint64_t base = 0;
  std::size_t kept_before = 0;
  std::vector<Span> spans;         ///< oldest first
  std::vector<Extremes> extremes;  ///< spans x followers
  std::vector<double> prefix, smoothed;

  double start_s = 0.0;
  Extremum previous;
  bool has_previous = false, first_open = true, finished = false;
  std::vector<Window> waiting;
  std::vector<PairedExtremum> pairs;
};

ExtremaPairer::ExtremaPairer(const Options& options) : impl_(std::make_unique<Impl>(options)) {}
ExtremaPairer::~ExtremaPairer() = default;
ExtremaPairer::ExtremaPairer(ExtremaPairer&&) noexcept = default;
ExtremaPairer& ExtremaPairer::operator=(ExtremaPairer&&) noexcept = default;

void ExtremaPairer::push(double t_s, double guide, const double* followers) {
  impl_->push(t_s, guide, followers);
}

void ExtremaPairer::push(std::span<const double> t_s, std::span<const float> guide,
                         std::span<const float* const> followers) {
  impl_->push(t_s, guide, followers);
}

void ExtremaPairer::finish() { impl_->finish(); }

const std::vector<PairedExtremum>& ExtremaPairer::pairs() const { return impl_->pairs; }

}  // namespace forcegate
