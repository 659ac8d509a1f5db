#include "hil/gate/waveform.h"

#include <algorithm>
#include <cmath>

namespace forcegate {

void WaveformKeeper::begin(const StimulusFacts& facts, double duration_s, double rate_Hz) {
  *this = WaveformKeeper();
  const double f_Hz = facts.lowest_frequency_Hz, third_s = duration_s / 3.0;
  const double wanted_s = std::clamp(f_Hz > 0.0 ? 2.0 / f_Hz : 10.0, 3.0, 40.0);
  const double length_s = std::min(wanted_s, third_s);
  per_step_ =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(length_s * rate_Hz / static_cast<double>(kRows)));
  const std::uint64_t samples = static_cast<std::uint64_t>(duration_s * rate_Hz), length = per_step_ * kRows;
  if (samples < 3 * length) return;
  const auto start = static_cast<std::uint64_t>(std::max(0.0, facts.excitation_start_s) * rate_Hz);
  const std::uint64_t middle = (samples - length) / 2, last = samples - length;
  for (const std::uint64_t first : {std::min(start, middle - std::min(middle, length)), middle, last}) {
    first_.push_back(first);
    RecordWindow& w = windows_.emplace_back();
    w.step_s = static_cast<double>(per_step_) / rate_Hz;
    w.t0_s = (static_cast<double>(first) + 0.5 * static_cast<double>(per_step_ - 1)) / rate_Hz;
    w.ati_N.reserve(kRows);
    w.dut_N.reserve(kRows);
  }
}

void WaveformKeeper::push(const RigBlock& block, const float* dut_N, std::size_t n) {
  for (std::size_t i = 0; i < n && at_ < first_.size();) {
    if (sample_ < first_[at_]) {
      const auto skip = std::min<std::uint64_t>(first_[at_] - sample_, n - i);
      sample_ += skip;
      i += skip;
      continue;
    }
    ati_ += block.force_ref_N[i];
    dut_ += dut_N[i];
    ++i, ++sample_;
    if (++filled_ < per_step_) continue;
    RecordWindow& w = windows_[at_];
    w.ati_N.push_back(static_cast<float>(ati_ / static_cast<double>(per_step_)));
    w.dut_N.push_back(static_cast<float>(dut_ / static_cast<double>(per_step_)));
    filled_ = 0;
    ati_ = dut_ = 0.0;
    if (w.ati_N.size() == kRows) ++at_;
  }
}

}  // namespace forcegate
