// Calibration of a reference by known masses, which twins lay on themselves.

#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <utility>

#include "hil/app/bench/bench_calibrate.h"

namespace forcegate {
namespace {

CalibrateRequest request_of(const char* bench) {
  CalibrateRequest q;
  q.bench = std::string(FORCEGATE_SOURCE_DIR "/rigs/") + bench;
  q.masses_g = {0.0, 100.0, 200.0};
  q.seconds = 0.2;
  q.settle_s = 0.1;
  return q;
}

bool sets_scale(const Calibrated& calibrated) {
  for (const std::string& line : calibrated.bench_lines)
    if (line.starts_with("counts_per_force")) return true;
  return false;
}

TEST(Calibrate, AScaleIsGivenForTheBenchFileWhereThisSetsItAndNotWhereItIsTheSensorsOwn) {
  for (const auto& [bench, set] : {std::pair{"twin.toml", true}, {"twin_netft.toml", false}}) {
    const Result<Calibrated> calibrated = calibrate_reference(request_of(bench), {});
    ASSERT_TRUE(calibrated) << bench << ": " << calibrated.error().to_text();
    EXPECT_EQ(sets_scale(*calibrated), set) << bench;
    EXPECT_NEAR(calibrated->line->slope, 1.0, 0.01) << bench;
  }
}

TEST(Calibrate, AnInterruptEndsTheWaitForALoadToSettle) {
  CalibrateRequest q = request_of("twin.toml");
  const std::atomic<bool> stop{true};
  q.settle_s = 1e9;  // who does not look is here until the test is ended
  q.stop = &stop;
  const Result<Calibrated> calibrated = calibrate_reference(q, {});
  ASSERT_FALSE(calibrated);
  EXPECT_EQ(calibrated.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace forcegate
