#pragma once
// Three short windows of a record's waveform (begin, middle, end) as means over equal steps: what a golden trace holds
// of it. Windows and steps follow from the profile alone, so that two records of one case have the same.

#include <cstdint>
#include <vector>

#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace forcegate {

struct RecordWindow {
  double t0_s = 0.0;  ///< middle of the first step
  double step_s = 0.0;
  std::vector<float> ati_N, dut_N;  ///< shorter when the record ended inside
};

class WaveformKeeper {
 public:
  static constexpr std::size_t kRows = 60;

  /// Two cycles of the lowest frequency, at least 3 s and at most 40 s or a third of the record, in kRows steps.
  void begin(const StimulusFacts& facts, double duration_s, double rate_Hz);
  void push(const RigBlock& block, const float* dut_N, std::size_t n);
  std::vector<RecordWindow> finish() { return std::move(windows_); }

 private:
  std::vector<RecordWindow> windows_;
  std::vector<std::uint64_t> first_;  ///< first sample of each window
  std::uint64_t per_step_ = 1, sample_ = 0, filled_ = 0;
  double ati_ = 0.0, dut_ = 0.0;
  std::size_t at_ = 0;  ///< window that is being filled
};

}  // namespace forcegate
