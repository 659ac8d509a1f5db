#include "hil/gate/sinks.h"

#include <algorithm>
#include <cmath>

namespace forcegate {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t kSpikeChunk = 4096;
constexpr const char* kNames[4] = {"set-point", "ATI", "firmware", "raw"};

template <class Rows>
std::vector<PlotTrace> to_traces(const Rows& rows) {
  std::vector<PlotTrace> traces;
  for (int k = 0; k < 4; ++k) {
    const bool any =
        std::any_of(rows.begin(), rows.end(), [k](const auto& r) { return std::isfinite(r.value[k]); });
    if (!any) continue;
    PlotTrace trace{kNames[k], "N", {}, {}};
    trace.t_s.reserve(rows.size());
    trace.value.reserve(rows.size());
    for (const auto& row : rows) {
      trace.t_s.push_back(static_cast<float>(row.t_s));
      trace.value.push_back(row.value[k]);
    }
    traces.push_back(std::move(trace));
  }
  return traces;
}

}  // namespace

void OutputWatch::begin(double rate_Hz, double excitation_start_s) {
  *this = OutputWatch();
  period_s_ = 1.0 / rate_Hz;
  follow_ = std::min(1.0, period_s_ / kDeparture_s);
  excitation_start_s_ = excitation_start_s;
  spike_rows_ = rate_Hz >= 500.0 ? static_cast<std::size_t>(std::lround(kSpike_s * rate_Hz)) : 0;
  recent_dut_.reserve(2 * spike_rows_ + kSpikeChunk);
  recent_raw_.reserve(2 * spike_rows_ + kSpikeChunk);
  if (spike_rows_ == 0) facts_.spike_N = std::numeric_limits<double>::quiet_NaN();
}

// A sensor's spike, a lost row and what the firmware makes of them within 0.2 s are no spike of the firmware's.
void OutputWatch::push_spikes(const RecordBlock& b, std::size_t from, std::size_t to) {
  const std::size_t w = spike_rows_, had = recent_dut_.size();
  recent_dut_.insert(recent_dut_.end(), b.dut_N.data() + from, b.dut_N.data() + to);
  recent_raw_.insert(recent_raw_.end(), b.raw_N.data() + from, b.raw_N.data() + to);
  const auto excursion = [w](const std::vector<float>& x, std::size_t i) {
    const float before = x[i - 2 * w], now = x[i - w], after = x[i];
    return std::max(now - std::max(before, after), std::min(before, after) - now);
  };
  const auto quiet = static_cast<std::uint64_t>(kSpikeOfCode_s / period_s_);
  double worst_N = facts_.spike_N;
  for (std::size_t i = std::max(had, 2 * w); i < recent_dut_.size(); ++i) {
    const std::size_t row = from + i - had;
    if (excursion(recent_raw_, i) > kSpikeOfCode_N || (b.rig->status[row] & kRigSampleLost) != 0) after_code_ = quiet;
    if (after_code_ > 0) {
      --after_code_;
      continue;
    }
    const auto spike_N = static_cast<double>(excursion(recent_dut_, i));
    if (!(spike_N > worst_N) || !std::isfinite(spike_N)) continue;
    worst_N = spike_N;
    facts_.spike_t_s = b.rig->t_s[row] - kSpike_s;
  }
  facts_.spike_N = worst_N;
  if (const std::size_t all = recent_dut_.size(); all > 2 * w) {
    recent_dut_.erase(recent_dut_.begin(), recent_dut_.end() - static_cast<std::ptrdiff_t>(2 * w));
    recent_raw_.erase(recent_raw_.begin(), recent_raw_.end() - static_cast<std::ptrdiff_t>(2 * w));
  }
}

void OutputWatch::push(const RecordBlock& b) {
  const float *dut_N = b.dut_N.data(), *ati_N = b.rig->force_ref_N.data();
  const std::uint8_t* flags = b.flags.data();
  // Independent lanes, because a minimum waits for its predecessor. NaN compares false and is left out.
  constexpr std::size_t kLanes = 8;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float low[kLanes], high[kLanes];
  std::fill_n(low, kLanes, kInfinity);
  std::fill_n(high, kLanes, -kInfinity);
  std::uint32_t strange = 0;
  std::uint8_t any_flag = 0;
  std::size_t i = 0;
  for (; i + kLanes <= b.n; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float force_N = dut_N[i + k];
      strange |= !(std::fabs(force_N) < kInfinity);
      low[k] = force_N < low[k] ? force_N : low[k];
      high[k] = force_N > high[k] ? force_N : high[k];
    }
  for (; i < b.n; ++i) {
    strange |= !(std::fabs(dut_N[i]) < kInfinity);
    low[0] = dut_N[i] < low[0] ? dut_N[i] : low[0];
    high[0] = dut_N[i] > high[0] ? dut_N[i] : high[0];
  }
  for (i = 0; i < b.n; ++i) any_flag |= flags[i];
  if (strange != 0) {
    push_strange(b);
  } else if (b.n > 0) {
    const auto least = static_cast<double>(*std::min_element(low, low + kLanes));
    const auto most = static_cast<double>(*std::max_element(high, high + kLanes));
    facts_.minimum_N = any_finite_ ? std::min(facts_.minimum_N, least) : least;
    facts_.maximum_N = any_finite_ ? std::max(facts_.maximum_N, most) : most;
    any_finite_ = true;
  }
  // What lies more than ten time constants before the end of the block is forgotten by there (e^-10).
  const auto memory = static_cast<std::size_t>(10.0 * kDeparture_s / period_s_);
  double departure_N = facts_.departure_N;
  for (i = b.n > memory ? b.n - memory : 0; i < b.n; ++i) {
    const double apart_N = std::fabs(static_cast<double>(dut_N[i]) - static_cast<double>(ati_N[i]));
    if (std::isfinite(apart_N)) departure_N += follow_ * (apart_N - departure_N);
  }
  facts_.departure_N = departure_N;
  for (std::size_t from = 0; spike_rows_ > 0 && from < b.n; from += kSpikeChunk) push_spikes(b, from, std::min(b.n, from + kSpikeChunk));
  constexpr std::uint8_t kCounted = kDutLearning | kDutHeld | kDutInputRail | kDutOutputClamped;
  if ((any_flag & kCounted) != 0 || learning_run_ > 0) push_flags(b);
}

void OutputWatch::push_strange(const RecordBlock& b) {
  for (std::size_t i = 0; i < b.n; ++i) {
    const double force_N = b.dut_N[i];
    if (!std::isfinite(force_N)) {
      if (facts_.not_finite++ == 0) facts_.first_not_finite_s = b.rig->t_s[i];
      continue;
    }
    facts_.minimum_N = any_finite_ ? std::min(facts_.minimum_N, force_N) : force_N;
    facts_.maximum_N = any_finite_ ? std::max(facts_.maximum_N, force_N) : force_N;
    any_finite_ = true;
  }
}

void OutputWatch::push_flags(const RecordBlock& b) {
  for (std::size_t i = 0; i < b.n; ++i) {
    const std::uint8_t flags = b.flags[i];
    if (flags & kDutLearning) {
      ++learning_run_;
      facts_.learning_longest_s =
          std::max(facts_.learning_longest_s, static_cast<double>(learning_run_) * period_s_);
      if (!first_episode_over_) facts_.learning_end_s = b.rig->t_s[i] + period_s_;
    } else if (learning_run_ > 0) {
      learning_run_ = 0;
      if (b.rig->t_s[i] >= excitation_start_s_) first_episode_over_ = true;
    }
    facts_.held += (flags & kDutHeld) != 0;
    facts_.input_rail += (flags & kDutInputRail) != 0;
    facts_.clamped += (flags & kDutOutputClamped) != 0;
  }
}

void HoldWatch::begin(double rate_Hz, double excitation_start_s) {
  *this = HoldWatch();
  rate_Hz_ = rate_Hz;
  excitation_start_s_ = excitation_start_s;
  last_setpoint_N_ = kNan;
}

void HoldWatch::push(const RecordBlock& b) {
  const auto settle = static_cast<std::uint64_t>(kSettle_s * rate_Hz_);
  for (std::size_t i = 0; i < b.n; ++i) {
    const float setpoint_N = b.rig->setpoint_N[i];
    if (setpoint_N != last_setpoint_N_) {
      if (b.rig->t_s[i] > excitation_start_s_ && std::isfinite(last_setpoint_N_))
        moved_N_ += std::fabs(static_cast<double>(setpoint_N) - last_setpoint_N_);
      run_ = 0;
      last_setpoint_N_ = setpoint_N;
      continue;
    }
    if (++run_ <= settle || moved_N_ < 1.0) continue;  // moved < 1 N: no cycling has come before
    const float ati_N = b.rig->force_ref_N[i];
    if (!std::isfinite(b.dut_N[i]) || !std::isfinite(ati_N)) continue;
    ++counted_;
    dut_ += b.dut_N[i];
    raw_ += b.raw_N[i];
    ati_ += ati_N;
  }
}

HoldFacts HoldWatch::finish() const {
  HoldFacts facts;
  if (counted_ == 0) return facts;
  const double n = static_cast<double>(counted_);
  facts.seconds = n / rate_Hz_;
  facts.dut_N = dut_ / n;
  facts.raw_N = raw_ / n;
  facts.ati_N = ati_ / n;
  return facts;
}

void LagEstimator::begin(double rate_Hz, double from_s, double until_s) {
  *this = LagEstimator();
  firmware_ = raw_ = raw_first_ = raw_second_ = LagFit(kGroup / rate_Hz);
  raw_far_ = LagSearch(kGroup / rate_Hz);
  from_s_ = from_s;
  between_s_ = 0.5 * (until_s - from_s);
  half_s_ = from_s + between_s_;
}

double LagEstimator::raw_lag_s() const {
  double lag_s = 0.0, unused = 0.0;
  raw_.finish(lag_s, unused);
  return std::isfinite(lag_s) ? lag_s : raw_far_.finish();
}

LagDrift LagEstimator::drift() const {
  LagDrift d;
  if (!second_half_) return d;
  double u_first_s = 0.0, u_second_s = 0.0;
  raw_first_.finish(d.first_lag_s, u_first_s);
  raw_second_.finish(d.second_lag_s, u_second_s);
  d.drift_ppm = 1e6 * (d.second_lag_s - d.first_lag_s) / between_s_;
  d.u_drift_ppm = 1e6 * std::sqrt(u_first_s * u_first_s + u_second_s * u_second_s) / between_s_;
  return d;
}

void LagEstimator::push(const RecordBlock& b) {
  const float *ati_N = b.rig->force_ref_N.data(), *dut_N = b.dut_N.data(), *raw_N = b.raw_N.data();
  double sum_x = sum_x_, sum_y = sum_y_, sum_raw = sum_raw_;
  int filled = filled_;
  for (std::size_t i = 0; i < b.n;) {
    const std::size_t end = std::min(b.n, i + static_cast<std::size_t>(kGroup - filled));
    filled += static_cast<int>(end - i);
    for (; i < end; ++i) {
      sum_x += ati_N[i];
      sum_y += dut_N[i];
      sum_raw += raw_N[i];
    }
    if (filled < kGroup) break;
    const double t_s = b.rig->t_s[end - 1], x = t_s < from_s_ ? kNan : sum_x / kGroup;
    firmware_.push(x, sum_y / kGroup);
    if (!second_half_ && t_s >= half_s_) {
      second_half_ = true;
      raw_first_ = raw_;
    }
    raw_.push(x, sum_raw / kGroup);
    raw_far_.push(x, sum_raw / kGroup);
    if (second_half_) raw_second_.push(x, sum_raw / kGroup);
    filled = 0;
    sum_x = sum_y = sum_raw = 0.0;
  }
  filled_ = filled;
  sum_x_ = sum_x, sum_y_ = sum_y, sum_raw_ = sum_raw;
}

void Overview::begin(std::uint64_t samples, std::size_t columns) {
  *this = Overview();
  per_column_ = std::max<std::uint64_t>(1, (samples + columns - 1) / columns);
  rows_.reserve(columns * kSlots + kSlots);
}

void Overview::close_column() {
  if (in_column_ == 0) return;
  Row sorted[kSlots];
  std::copy(std::begin(slot_), std::end(slot_), sorted);
  std::sort(std::begin(sorted), std::end(sorted), [](const Row& a, const Row& b) { return a.t_s < b.t_s; });
  for (const Row& row : sorted)
    if (rows_.size() < rows_.capacity() && (rows_.empty() || row.t_s > rows_.back().t_s))
      rows_.push_back(row);
  in_column_ = 0;
}

void Overview::push(const RecordBlock& b) {
  for (std::size_t i = 0; i < b.n; ++i) {
    const float ati = b.rig->force_ref_N[i], dut = b.dut_N[i];
    const float error = dut - ati;
    const float key[kSlots] = {0.0f, -ati, ati, -dut, dut, -error, error, 0.0f};
    const bool start = in_column_ == 0;
    bool taken = start;
    for (int k = ati_low; k <= error_high; ++k) taken |= key[k] > best_[k];
    const bool end = ++in_column_ >= per_column_;
    if (!taken && !end) continue;
    const Row row{b.rig->t_s[i], {b.rig->setpoint_N[i], ati, dut, b.raw_N[i]}};
    if (start) {
      std::fill(std::begin(slot_), std::end(slot_), row);
      for (int k = ati_low; k <= error_high; ++k)
        best_[k] = std::isfinite(key[k]) ? key[k] : -std::numeric_limits<float>::infinity();
    } else {
      for (int k = ati_low; k <= error_high; ++k)
        if (key[k] > best_[k]) {
          best_[k] = key[k];
          slot_[k] = row;
        }
    }
    if (end) {
      slot_[last] = row;
      close_column();
    }
  }
}

std::vector<PlotTrace> Overview::finish() {
  close_column();
  return to_traces(rows_);
}

void WindowKeeper::begin(double rate_Hz, double length_s, std::size_t capacity, std::size_t block_rows) {
  *this = WindowKeeper();
  length_s_ = length_s;
  const double samples = std::max(1.0, length_s * rate_Hz);
  stride_ = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::ceil(samples / static_cast<double>(capacity))));
  rows_ = std::max<std::size_t>(2, static_cast<std::size_t>(samples) / stride_);
  ring_.resize(rows_ + block_rows / stride_ + 1);
  kept_.reserve(rows_);
}

void WindowKeeper::push(const RecordBlock& b) {
  for (std::size_t i = 0; i < b.n; ++i) {
    if (skip_++ % stride_ != 0) continue;
    ring_[at_] = {b.rig->t_s[i], {b.rig->setpoint_N[i], b.rig->force_ref_N[i], b.dut_N[i], b.raw_N[i]}};
    if (++at_ == ring_.size()) at_ = 0;
    filled_ = std::min(filled_ + 1, ring_.size());
  }
  if (open_ && b.n > 0 && b.rig->t_s[b.n - 1] >= end_s_) keep_until(end_s_);
}

void WindowKeeper::around(double t_s) {
  wanted_ = open_ = true;
  end_s_ = std::max(t_s + 0.5 * length_s_, length_s_);
  if (filled_ > 0 && ring_[(at_ + ring_.size() - 1) % ring_.size()].t_s >= end_s_) keep_until(end_s_);
}

void WindowKeeper::keep_until(double end_s) {
  open_ = false;
  kept_.clear();
  const std::size_t start = filled_ < ring_.size() ? 0 : at_;
  const auto row = [&](std::size_t i) -> const Row& { return ring_[(start + i) % ring_.size()]; };
  std::size_t end = filled_;
  while (end > 0 && row(end - 1).t_s > end_s) --end;
  const std::size_t first = end > rows_ ? end - rows_ : 0;
  for (std::size_t i = first; i < std::min(first + rows_, filled_); ++i) kept_.push_back(row(i));
}

std::vector<PlotTrace> WindowKeeper::finish() {
  if (open_ || !wanted_) keep_until(std::numeric_limits<double>::infinity());
  return to_traces(kept_);
}

}  // namespace forcegate
