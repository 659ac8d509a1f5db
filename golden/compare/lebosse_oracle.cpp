#include "golden/compare/lebosse_oracle.h"

#include <algorithm>
#include <cmath>

#include "hil/base/portable_math.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

constexpr std::int64_t kSmooth = 8, kWindow = 19456, kClose = 19712, kQuarter = kWindow / 4;
constexpr std::int64_t kPoints = 512, kDecimation = 38, kBins = 102;
constexpr std::int64_t kBucket = 10240, kBuckets = 12;
constexpr std::int64_t kQuiet = 5000;  // shortest rest that ends an excitation

std::int64_t floor_shift20(std::int64_t v) { return v >= 0 ? v / 1048576 : -((-v + 1048575) / 1048576); }

// round(2^14 cos(2 pi k / 512)), as an integer table.
const std::array<std::int64_t, 512>& cosine_table() {
  static const std::array<std::int64_t, 512> table = [] {
    std::array<std::int64_t, 512> t{};
    for (std::size_t k = 0; k < t.size(); ++k)
      t[k] = std::llround(16384.0 * portable::cos(6.28318530717958647692 * static_cast<double>(k) / 512.0));
    return t;
  }();
  return table;
}

}  // namespace

LebosseOracle::LebosseOracle(const Calibration& c)
    : gain_(static_cast<float>(c.gain_N_per_V)),
      offset_(static_cast<float>(c.offset_N)),
      b_scale_(static_cast<float>(c.b_scale)),
      q_scale_(static_cast<float>(c.q_scale)),
      code_max_((std::int64_t{1} << c.adc_bits) - 1) {
  volt_ = static_cast<double>(static_cast<float>(c.v_range_V)) / static_cast<double>(code_max_);
  hysteresis_ = kSmooth * code_max_ / 128;
  band_ = kSmooth * code_max_ / 256;
  block_.reserve(kPoints);
}

double LebosseOracle::rate_per_s(double f_Hz) const {
  return b_scale_ * (0.0056 + 0.0019 * std::min(f_Hz, 5.0));
}

double LebosseOracle::ratio(double amplitude_N) const {
  const double a = std::clamp(amplitude_N, 0.02, 5.0);
  return q_scale_ / (1.0 + 1.377 * a * a);
}

double LebosseOracle::factor(double b, double q, double age_s) {
  return (1.0 + q) / (portable::exp(-b * age_s) + q);
}

void LebosseOracle::solve_ratio() {
  const double half_N = 0.5 * gain_ * volt_ / kSmooth * static_cast<double>(peak_.value - trough_);
  q_ = ratio(half_N);
  for (int k = 0; k < 4; ++k) q_ = ratio(half_N * factor(b_, q_, peak_age_s_));
}

void LebosseOracle::take_peak(std::size_t first_quarter) {
  bool any = false;
  for (std::size_t k = first_quarter; k < 4; ++k) {
    if (!has_high_[k] || (any && quarter_[k].value <= peak_.value)) continue;
    peak_ = quarter_[k];
    any = true;
  }
  peak_age_s_ = age_s(peak_.at);
}

void LebosseOracle::open_window() {
  window_ = i_;
  open_ = true;
  block_.clear();
  block_sum_ = block_n_ = 0;
  has_high_ = has_low_ = {};
}

void LebosseOracle::arm(std::int64_t onset, bool rising) {
  phase_ = Phase::armed;
  peaks_ = troughs_ = longest_ = 0;
  last_turn_ = onset;
  rising_ = rising;
  extreme_ = {sum_, i_};
  if (!known_) {
    onset_ = onset;
    open_window();
  }
}

void LebosseOracle::quiet() {
  std::int64_t limit = kQuiet;
  if (phase_ == Phase::cycling) limit = std::clamp<std::int64_t>(2 * interval_, kQuiet, 20000);
  if (i_ - still_since_ < limit) return;
  if (phase_ == Phase::armed) {
    phase_ = known_ ? Phase::held : Phase::rest;
    return;
  }
  fast_ = true;
  if (open_) {
    known_ = false;
    phase_ = Phase::rest;
  } else {
    phase_ = Phase::held;
    held_since_ = i_;
    exposure_ = i_ - onset_;
  }
}

inline void LebosseOracle::movement() {
  const std::int64_t moved = sum_ - still_value_;
  const bool active = phase_ == Phase::armed || phase_ == Phase::cycling;
  if (std::abs(moved) > band_) {
    still_value_ = sum_;
    still_since_ = i_;
    if (!active) arm(i_, moved > 0);
  } else if (active && i_ - still_since_ >= kQuiet) {
    quiet();
  }
  if (phase_ == Phase::held && (i_ - held_since_) / 6 >= exposure_) {
    phase_ = Phase::rest;
    known_ = false;
  }
}

inline void LebosseOracle::turning() {
  const std::int64_t onward = rising_ ? sum_ - extreme_.value : extreme_.value - sum_;
  if (onward > 0) {
    extreme_ = {sum_, i_};
  } else if (-onward > hysteresis_) {
    const Extreme turned = extreme_;
    const bool peak = rising_;
    rising_ = !rising_;
    extreme_ = {sum_, i_};
    turning_point(peak, turned);
  }
}

void LebosseOracle::turning_point(bool peak, Extreme turned) {
  const std::int64_t since = std::max<std::int64_t>(0, turned.at - last_turn_);
  if (phase_ == Phase::armed && since > 30000) {
    arm(turned.at, !peak);
  } else {
    interval_ = since;
    longest_ = std::max(longest_, since);
  }
  last_turn_ = turned.at;
  if (phase_ == Phase::armed && peaks_ + troughs_ == 0) {
    first_turn_ = turned.at;
    seen_first_turn_ = i_;
  }
  if (peak) {
    ++peaks_;
  } else {
    armed_trough_ = troughs_ == 0 ? turned.value : std::min(armed_trough_, turned.value);
    ++troughs_;
  }
  if (phase_ == Phase::armed && peaks_ > 0 && troughs_ > 0) confirm();
}

void LebosseOracle::confirm() {
  phase_ = Phase::cycling;
  floor_restart(armed_trough_);
  fast_ = known_;
  if (known_) {
    onset_ = i_ - std::max<std::int64_t>(0, exposure_ - (i_ - held_since_) / 6);
    return;
  }
  const std::int64_t way = first_turn_ - onset_;
  const bool ramp = way < kWindow ? 3 * way > 8 * interval_ : way > interval_;
  if (!ramp) return;
  onset_ = first_turn_ - interval_;
  if (way - interval_ > 4000) open_window();
}

void LebosseOracle::floor_restart(std::int64_t value) {
  bucket_number_ = in_bucket_ = 0;
  slot_ = 0;
  bucket_[0] = value;
  floor_ = value;
}

void LebosseOracle::next_bucket() {
  in_bucket_ = 0;
  ++bucket_number_;
  slot_ = static_cast<std::size_t>(bucket_number_ % kBuckets);
  bucket_[slot_] = sum_;
  const auto used = static_cast<std::ptrdiff_t>(std::min(bucket_number_ + 1, kBuckets));
  floor_ = *std::min_element(bucket_.begin(), bucket_.begin() + used);
}

inline void LebosseOracle::floor_push() {
  if (in_bucket_ == kBucket) next_bucket();
  ++in_bucket_;
  bucket_[slot_] = std::min(bucket_[slot_], sum_);
  floor_ = std::min(floor_, sum_);
}

inline void LebosseOracle::observe(std::uint16_t code) {
  const std::int64_t age = i_ - window_;
  if (age < kWindow) {
    const auto k = static_cast<std::size_t>(age / kQuarter);
    if (!has_high_[k] || sum_ > quarter_[k].value) quarter_[k] = {sum_, i_};
    has_high_[k] = true;
    if (phase_ == Phase::cycling) {
      quarter_low_[k] = has_low_[k] ? std::min(quarter_low_[k], sum_) : sum_;
      has_low_[k] = true;
    }
    block_sum_ += code;
    if (++block_n_ == kDecimation) {
      block_.push_back(block_sum_);
      block_sum_ = block_n_ = 0;
    }
  }
}

std::int64_t LebosseOracle::lowest_bin() const {
  const auto& cosine = cosine_table();
  std::array<std::int64_t, kBins + 1> re{}, im{};
  for (std::size_t k = 1; k <= kBins; ++k)
    for (std::size_t n = 0; n < block_.size(); ++n) {
      const std::size_t phase = k * n % kPoints;
      re[k] += block_[n] * cosine[phase];
      im[k] -= block_[n] * cosine[(phase + 384) % kPoints];
    }
  std::array<std::int64_t, kBins + 1> power{};
  for (std::size_t k = 1; k < kBins; ++k) {  // re[0] = im[0] = 0: the mean does not count
    const std::int64_t x = floor_shift20(2 * re[k] - re[k - 1] - re[k + 1]);
    const std::int64_t y = floor_shift20(2 * im[k] - im[k - 1] - im[k + 1]);
    power[k] = x * x + y * y;
  }
  const std::int64_t strongest = *std::max_element(power.begin(), power.end());
  for (std::size_t k = 1; k < kBins; ++k)
    if (25 * power[k] >= strongest && power[k] >= power[k - 1] && power[k] >= power[k + 1])
      return static_cast<std::int64_t>(k);
  return 0;
}

void LebosseOracle::close_window() {
  const std::int64_t bin = lowest_bin();
  b_ = rate_per_s(static_cast<double>(bin) * 1000.0 / static_cast<double>(kWindow));
  slow_ = bin <= 2;
  take_peak(slow_ ? 0 : 1);
  if (!slow_) {
    bool any = false;
    std::int64_t low = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      if (!has_low_[k]) continue;
      low = any ? std::min(low, quarter_low_[k]) : quarter_low_[k];
      any = true;
    }
    if (any) floor_restart(low);
  }
  trough_ = floor_;
  solve_ratio();
  open_ = false;
  known_ = true;
}

void LebosseOracle::tick() {
  double target = 1.0;
  if (phase_ == Phase::cycling) {
    if (open_) {
      b_ = rate_per_s(longest_ > 0 ? 500.0 / static_cast<double>(longest_) : 0.0);
      take_peak(0);
      trough_ = floor_;
      solve_ratio();
    } else if (slow_ && i_ - onset_ < 120000 && floor_ < trough_) {
      trough_ = floor_;
      solve_ratio();
    }
    target = factor(b_, q_, age_s(i_));
    floor_V_ = volt_ / kSmooth * static_cast<double>(floor_);
  }
  const double step = fast_ ? 1.0 / 128.0 : 1.0 / 1024.0;
  if (std::abs(target - factor_) > step) {
    factor_ += target > factor_ ? step : -step;
  } else {
    factor_ = target;
    fast_ = false;
  }
}

LebosseOracle::Output LebosseOracle::step(std::uint16_t code) {
  if (++i_ == 0) {
    last_.fill(code);
    sum_ = still_value_ = kSmooth * code;
  }
  auto& oldest = last_[static_cast<std::size_t>(i_) % last_.size()];
  sum_ += code - oldest;
  oldest = code;

  movement();
  if (phase_ == Phase::armed || phase_ == Phase::cycling) {
    turning();
    if (open_) observe(code);
    if (phase_ == Phase::cycling) {
      floor_push();
      if (open_ && i_ - window_ >= kClose) close_window();
    }
  }
  if (static_cast<std::size_t>(i_) % 8 == 7) tick();

  double voltage = volt_ * code;
  if (voltage > floor_V_ && factor_ > 1.0) voltage = floor_V_ + factor_ * (voltage - floor_V_);
  Output out{gain_ * voltage + offset_, 0};
  if (phase_ == Phase::cycling) out.flags |= kDutExcited;
  if (phase_ == Phase::held) out.flags |= kDutHeld;
  const bool learning = phase_ == Phase::cycling || (phase_ == Phase::armed && peaks_ + troughs_ > 0);
  if (open_ && learning && i_ - seen_first_turn_ < kClose) out.flags |= kDutLearning;
  if (code == 0 || code >= code_max_) out.flags |= kDutInputRail;
  if (std::abs(out.force_N) > 10.0) {
    out.force_N = std::copysign(10.0, out.force_N);
    out.flags |= kDutOutputClamped;
  }
  return out;
}

}  // namespace forcegate
