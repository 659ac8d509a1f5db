#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "hil/interface/comparator.h"
#include "hil/interface/dut.h"

namespace forcegate::test {

inline std::filesystem::path image(const std::string& name) {
  return std::filesystem::path(FORCEGATE_BINARY_DIR) / "firmware" / name;
}

inline Result<std::unique_ptr<Dut>> make_dut(const std::string& lane,
                                             const std::map<std::string, std::string>& options = {}) {
  return Registry<LaneKind>::instance().find(lane)->make(options);
}

struct Output {
  DutInfo info;
  DutCounters counters;
  DutResources resources;
  std::vector<float> force_N;
  std::vector<std::uint8_t> flags;
};

inline Calibration calibration_of(double gain, double offset) {
  Calibration c;
  c.gain_N_per_V = gain;
  c.offset_N = offset;
  c.id = "test";
  return c;
}

inline Result<Output> feed(Dut& dut, DutInfo info, std::span<const std::uint16_t> adc, std::size_t block) {
  Output out;
  out.info = std::move(info);
  out.force_N.resize(adc.size());
  out.flags.resize(adc.size());
  for (std::size_t at = 0; at < adc.size(); at += block) {
    const std::size_t n = std::min(block, adc.size() - at);
    FORCEGATE_CHECK_OK(dut.process(static_cast<std::uint32_t>(at), adc.subspan(at, n),
                                   std::span(out.force_N).subspan(at, n),
                                   std::span(out.flags).subspan(at, n)));
  }
  return out;
}

inline DutSession session_of(const std::filesystem::path& path, const Calibration& calibration) {
  DutSession session;
  session.image = path;
  session.nonce = 0xC0FFEE;
  session.calibration = calibration;
  return session;
}

inline Result<Output> run(const std::string& lane, const std::filesystem::path& path,
                          const Calibration& calibration, std::span<const std::uint16_t> adc,
                          std::size_t block = 4096) {
  FORCEGATE_TRY(auto dut, make_dut(lane));
  FORCEGATE_TRY(DutInfo info, dut->open(session_of(path, calibration)));
  FORCEGATE_TRY(Output out, feed(*dut, std::move(info), adc, block));
  FORCEGATE_TRY(out.counters, dut->close());
  out.resources = dut->resources();
  return out;
}

/// Another session first, then RESET and the one that counts.
inline Result<Output> run_after(const std::string& lane, const std::filesystem::path& path,
                                const Calibration& calibration_before,
                                std::span<const std::uint16_t> adc_before, const Calibration& calibration,
                                std::span<const std::uint16_t> adc) {
  FORCEGATE_TRY(auto dut, make_dut(lane));
  FORCEGATE_TRY(DutInfo first, dut->open(session_of(path, calibration_before)));
  FORCEGATE_TRY(const Output before, feed(*dut, std::move(first), adc_before, 4096));
  FORCEGATE_TRY(DutInfo second, dut->restart(session_of(path, calibration)));
  FORCEGATE_TRY(Output out, feed(*dut, std::move(second), adc, 4096));
  FORCEGATE_TRY(out.counters, dut->close());
  return out;
}

inline Comparison conformance(const Output& out, const Calibration& calibration,
                              std::span<const std::uint16_t> adc) {
  auto comparator = Registry<ComparatorKind>::instance().find("conformance")->make();
  EXPECT_TRUE(comparator->begin({out.info.algorithm_id, calibration, 1000.0}));
  comparator->push(adc, out.force_N, out.flags);
  return comparator->finish();
}

}  // namespace forcegate::test
