#pragma once
// A rig that is a recording.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hil/interface/rig.h"

namespace forcegate::test {

/// Plays given columns and ends.
class RecordedRig final : public Rig {
 public:
  std::vector<float> force_N, sensor_V;
  double rate_Hz = 100.0;
  std::string assumed, notes;
  bool in_counts = false;

  RigInfo info() const override {
    RigInfo i;
    if (!assumed.empty()) i.details["assumed"] = assumed;
    if (!notes.empty()) i.details["notes"] = notes;
    if (in_counts) i.details["output"] = "counts";
    i.rate_Hz = rate_Hz;
    i.adc_bits = 16;
    return i;
  }
  Result<void> begin(const RigRecordRequest&) override {
    at_ = 0;
    return {};
  }
  Result<void> command_velocity(double) override { return {}; }
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t to) override {
    n = std::min(n, force_N.size() - at_);
    for (std::size_t i = 0; i < n; ++i, ++at_) {
      out.t_s[to + i] = static_cast<double>(at_) / rate_Hz;
      out.force_ref_N[to + i] = force_N[at_];
      const auto code = std::clamp(std::lround(static_cast<double>(sensor_V[at_]) * 6553.5), 0L, 65535L);
      out.adc[to + i] = static_cast<std::uint16_t>(code);
      out.status[to + i] = code == 0 || code == 65535 ? kRigAdcRail : 0;
    }
    return n;
  }
  double theta_rad() const override { return 0.0; }
  double force_ref_N() const override { return 0.0; }
  void park() noexcept override {}

 private:
  std::size_t at_ = 0;
};

}  // namespace forcegate::test
