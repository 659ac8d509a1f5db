#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint64_t kSpansPerAge = 256;

/// Extremes of one follower over one span of samples.
struct Extremes {
  double high = -kInfinity, high_s = kNone;
  double low = kInfinity, low_s = kNone;

  void add(double value, double t_s) {  // a NaN compares false and is left out
    if (value > high) high = value, high_s = t_s;
    if (value < low) low = value, low_s = t_s;
  }
  void add(const Extremes& later) {
    if (later.high > high) high = later.high, high_s = later.high_s;
    if (later.low < low) low = later.low, low_s = later.low_s;
  }
};

struct Span {
  double first_s = 0.0, last_s = 0.0;
  std::uint64_t end = 0;  ///< sample number one past its last
  std::uint32_t n = 0;
};

/// Moving mean over the last `width` samples of one channel, non-finite ones left out. The sum is made anew once a
/// turn of the ring, so that rounding cannot accumulate.
class MovingMean {
 public:
  explicit MovingMean(std::size_t width) : ring_(width, kNone) {}

  double push(double value) {
    double& slot = ring_[at_];
    if (std::isfinite(slot)) sum_ -= slot, --count_;
    slot = value;
    if (std::isfinite(value)) sum_ += value, ++count_;
    if (++at_ == ring_.size()) {
      at_ = 0;
      sum_ = 0.0;
      for (const double kept : ring_)
        if (std::isfinite(kept)) sum_ += kept;
    }
    return count_ > 0 ? sum_ / static_cast<double>(count_) : kNone;
  }

 private:
  std::vector<double> ring_;
  std::size_t at_ = 0, count_ = 0;
  double sum_ = 0.0;
};

struct Window {
  Extremum turn;
  double from_s = 0.0, to_s = kInfinity;
};

}  // namespace

struct ExtremaPairer::Impl {
  explicit Impl(const Options& o)
      : options(o), turning(o.prominence), means(o.followers, MovingMean(2 * width_of(o) + 1)),
        instants(width_of(o) + 1, 0.0), smooth(o.followers), open(o.followers) {}

  static std::size_t width_of(const Options& o) { return static_cast<std::size_t>(std::max(0, o.half_width)); }

  void push(double t_s, double guide, const double* followers) {
    if (pushed == 0) record_start_s = t_s;
    if (options.half_width <= 0) {
      store(t_s, followers);
    } else {
      // the mean of 2 h + 1 samples belongs to the instant h samples ago
      const std::size_t h = width_of(options);
      instants[instant_at] = t_s;
      instant_at = instant_at == h ? 0 : instant_at + 1;
      for (std::size_t k = 0; k < smooth.size(); ++k) smooth[k] = means[k].push(followers[k]);
      if (pushed >= h) store(instants[instant_at], smooth.data());
    }
    ++pushed;
    last_s = t_s;
    if (turning.push(t_s, guide)) turned(turning.last());
    if (ready_s < stored_s) emit_ready();
  }

  void store(double t_s, const double* values) {
    if (open_span.n == 0) {
      open_span.first_s = t_s;
      std::fill(open.begin(), open.end(), Extremes{});
    }
    open_span.last_s = t_s;
    open_span.end = ++stored;
    ++open_span.n;
    stored_s = t_s;
    for (std::size_t k = 0; k < open.size(); ++k) open[k].add(values[k], t_s);
    if (open_span.n >= span_target) close_span();
  }

  void close_span() {
    if (open_span.n == 0) return;
    spans.push_back(open_span);
    extremes.insert(extremes.end(), open.begin(), open.end());
    open_span.n = 0;
    if (spans.size() >= merge_at) merge_old();
  }

  /// Joins neighbours whose common length stays below 1/256 of their age.
  void merge_old() {
    const std::size_t followers = open.size();
    std::size_t to = 0;
    for (std::size_t from = head; from < spans.size(); ++from) {
      const bool join = to > 0 && (spans[to - 1].n + spans[from].n) * kSpansPerAge <= stored - spans[from].end;
      if (join) {
        spans[to - 1].last_s = spans[from].last_s;
        spans[to - 1].end = spans[from].end;
        spans[to - 1].n += spans[from].n;
        for (std::size_t k = 0; k < followers; ++k)
          extremes[(to - 1) * followers + k].add(extremes[from * followers + k]);
        continue;
      }
      spans[to] = spans[from];
      for (std::size_t k = 0; k < followers; ++k) extremes[to * followers + k] = extremes[from * followers + k];
      ++to;
    }
    spans.resize(to);
    extremes.resize(to * followers);
    head = 0;
    merge_at = std::max<std::size_t>(1024, 2 * to);
  }

  void turned(const Extremum& turn) {
    Window window{turn, record_start_s, kInfinity};
    if (has_previous) {
      const double middle_s = 0.5 * (previous.t_s + turn.t_s) + options.lag_s;
      window.from_s = middle_s;
      waiting.back().to_s = middle_s;
      if (waiting.size() == 1 && first_open) {
        waiting.back().from_s =
            std::max(record_start_s, previous.t_s + options.lag_s - 0.5 * (turn.t_s - previous.t_s));
        first_open = false;
      }
      const std::uint64_t half_cycle = pushed - previous_at;
      span_target = 1;
      while (2 * span_target * 128 <= half_cycle) span_target *= 2;
    }
    waiting.push_back(window);
    previous = turn;
    previous_at = pushed;
    has_previous = true;
    ready_s = waiting.front().to_s;
  }

  void emit_ready() {
    while (!waiting.empty() && waiting.front().to_s < stored_s) {
      emit(waiting.front());
      waiting.erase(waiting.begin());
    }
    ready_s = waiting.empty() ? kInfinity : waiting.front().to_s;
  }

  void emit(const Window& window) {
    const std::size_t followers = open.size();
    std::vector<Extremes> found(followers);
    while (head < spans.size() && spans[head].last_s < window.from_s) ++head;
    std::size_t at = head;
    for (; at < spans.size() && spans[at].first_s <= window.to_s; ++at)
      for (std::size_t k = 0; k < followers; ++k) found[k].add(extremes[at * followers + k]);
    if (at == spans.size() && open_span.n > 0 && open_span.first_s <= window.to_s)
      for (std::size_t k = 0; k < followers; ++k) found[k].add(open[k]);
    while (head < spans.size() && spans[head].last_s < window.to_s) ++head;

    PairedExtremum pair;
    pair.turn = window.turn.turn;
    pair.t_s = window.turn.t_s;
    pair.guide = window.turn.value;
    for (const Extremes& e : found) {
      const bool any = std::isfinite(e.high);
      const bool maximum = pair.turn == Turn::maximum;
      pair.value.push_back(!any ? kNone : maximum ? e.high : e.low);
      pair.at_s.push_back(!any ? kNone : maximum ? e.high_s : e.low_s);
    }
    pairs.push_back(std::move(pair));
  }

  void finish() {
    if (finished) return;
    finished = true;
    if (waiting.empty()) return;
    // the last turning point has no successor: its window is as long after it as before it
    Window& last = waiting.back();
    if (pairs.empty() && waiting.size() == 1 && first_open)
      last.from_s = record_start_s;  // a single turning point: the whole record is its window
    const double before_s = last.turn.t_s + options.lag_s - last.from_s;
    last.to_s = last.turn.t_s + options.lag_s + before_s;
    const double step_s = pushed > 1 ? (last_s - record_start_s) / static_cast<double>(pushed - 1) : 0.0;
    const double end_s = last_s + 0.5 * step_s;
    for (const Window& window : waiting)
      if (window.to_s <= end_s) emit(window);
    waiting.clear();
  }

  Options options;
  TurningPoints turning;
  std::vector<MovingMean> means;
  std::vector<double> instants;  ///< the last half_width + 1 instants
  std::size_t instant_at = 0;
  std::vector<double> smooth;

  std::vector<Span> spans;  ///< oldest first; those before `head` are no longer needed
  std::vector<Extremes> extremes;
  std::size_t head = 0, merge_at = 1024;
  Span open_span;
  std::vector<Extremes> open;
  std::uint32_t span_target = 1;

  std::uint64_t pushed = 0, stored = 0, previous_at = 0;
  double record_start_s = 0.0, last_s = 0.0, stored_s = -kInfinity, ready_s = kInfinity;
  Extremum previous;
  bool has_previous = false, first_open = true, finished = false;
  std::vector<Window> waiting;
  std::vector<PairedExtremum> pairs;
};

ExtremaPairer::ExtremaPairer(const Options& options) : impl_(std::make_unique<Impl>(options)) {}
ExtremaPairer::~ExtremaPairer() = default;
ExtremaPairer::ExtremaPairer(ExtremaPairer&&) noexcept = default;
ExtremaPairer& ExtremaPairer::operator=(ExtremaPairer&&) noexcept = default;

void ExtremaPairer::push(double t_s, double guide, const double* followers) { impl_->push(t_s, guide, followers); }

void ExtremaPairer::push(std::span<const double> t_s, std::span<const float> guide,
                         std::span<const float* const> followers) {
  std::vector<double> row(followers.size());
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = followers[k][i];
    impl_->push(t_s[i], guide[i], row.data());
  }
}

void ExtremaPairer::finish() { impl_->finish(); }

const std::vector<PairedExtremum>& ExtremaPairer::pairs() const { return impl_->pairs; }

}  // namespace forcegate
