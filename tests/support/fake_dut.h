#pragma once
// A firmware that is nothing but the static law, and can be made to misbehave.

#include <functional>

#include "hil/interface/dut.h"

namespace forcegate::testing {

class FakeDut : public Dut {
 public:
  /// Called for each answer: index, force, flags.
  std::function<void(std::uint32_t index, float& force_N, std::uint8_t& flags)> spoil;
  bool wrong_nonce = false;
  double only_rate_Hz = 0.0;  ///< 0: any
  std::uint32_t dies_at = 0xFFFFFFFF;
  DutCounters counters;

  Result<DutInfo> open(const DutSession& session) override {
    session_ = session;
    if (only_rate_Hz > 0.0 && only_rate_Hz != session.rate_Hz) return wrong_rate(only_rate_Hz, session.rate_Hz, "fake");
    DutInfo info;
    info.protocol_major = 1;
    info.board = "fake";
    info.algorithm_id = "static/1";
    info.nonce = session.nonce + (wrong_nonce ? 1 : 0);
    info.adc_bits = session.calibration.adc_bits;
    info.rate_Hz = session.rate_Hz;
    return info;
  }
  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    if (first_index + adc.size() > dies_at)
      return fail(ErrorCode::firmware, "the image does not answer any more");
    const Calibration& c = session_.calibration;
    for (std::size_t i = 0; i < adc.size(); ++i) {
      force_N[i] = static_cast<float>(c.gain_N_per_V * adc[i] / 65535.0 * c.v_range_V + c.offset_N);
      flags[i] = 0;
      if (spoil) spoil(first_index + static_cast<std::uint32_t>(i), force_N[i], flags[i]);
    }
    counters.samples += adc.size();
    return {};
  }
  Result<DutCounters> close() override { return counters; }

 private:
  DutSession session_;
};

}  // namespace forcegate::testing
