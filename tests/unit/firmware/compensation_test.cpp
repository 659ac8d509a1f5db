#include <cmath>

#include "hil/interface/firmware_guard.h"
#include "tests/unit/firmware/record.h"
#include "tests/unit/firmware/run.h"

namespace forcegate::test {
namespace {

constexpr char kReference[] = "reference.native.so";

TEST(Compensation, RestoresTheMaximaOfTwentyMinutesOfCyclingAndKeepsTheMinima) {
  for (const double f_Hz : {0.05, 0.25, 0.5, 2.0, 4.0}) {
    for (const double b_scale : {0.75, 1.25}) {
      Decay d;
      d.f_Hz = f_Hz;
      d.b_scale = b_scale;
      const Record r = decaying_sine(d);
      Calibration c = calibration_of(d.gain_N_per_V, d.offset_N);
      c.b_scale = b_scale;
      const auto out = run("native", image(kReference), c, r.adc);
      ASSERT_TRUE(out) << out.error().to_text();
      double worst = 0.0;
      for (std::size_t i = 30000; i < r.adc.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(out->force_N[i]) - r.force_N[i]));
      EXPECT_LT(worst, 0.10) << "f " << f_Hz << " b scale " << b_scale;  // 3 % of the maximum
    }
  }
}

TEST(Compensation, LearnsForLessThanTwentySecondsAndSaysSo) {
  const Record r = decaying_sine({.duration_s = 60.0});
  const auto out = run("native", image(kReference), calibration_of(0.5, 0.15), r.adc);
  ASSERT_TRUE(out);
  std::size_t learning = 0, last = 0;
  for (std::size_t i = 0; i < out->flags.size(); ++i)
    if (out->flags[i] & kDutLearning) {
      ++learning;
      last = i;
    }
  EXPECT_GT(learning, 10000U);
  EXPECT_LE(last, 20000U);
  EXPECT_TRUE(out->flags.back() & kDutExcited);
}

TEST(Compensation, DoesNotAmplifyAHoldAfterCyclingOrARecordThatNeverCycles) {
  Record r = decaying_sine({.duration_s = 300.0});
  const std::size_t stop = r.adc.size();
  r.adc.insert(r.adc.end(), 300000, to_code(4.0));
  const auto out = run("native", image(kReference), calibration_of(0.5, 0.15), r.adc);
  ASSERT_TRUE(out);
  for (std::size_t i = stop + 10000; i < r.adc.size(); ++i) {
    ASSERT_NEAR(out->force_N[i], 0.5 * 4.0 + 0.15, 1e-3) << i;
    ASSERT_TRUE(out->flags[i] & kDutHeld) << i;
  }
  std::vector<std::uint16_t> steps;  // a staircase with dwell
  for (int level = 0; level < 10; ++level) steps.insert(steps.end(), 20000, to_code(level));
  const auto still = run("native", image(kReference), calibration_of(0.5, 0.15), steps);
  ASSERT_TRUE(still);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    ASSERT_NEAR(still->force_N[i], 0.5 * (steps[i] / 6553.5) + 0.15, 1e-4) << i;
    ASSERT_FALSE(still->flags[i] & kDutExcited) << i;
  }
}

TEST(Compensation, IsBoundedAndANumberForAnyCodes) {
  Rng rng(7);
  std::vector<std::uint16_t> adc(400000);
  int level = 0;
  for (std::size_t i = 0; i < adc.size(); ++i) {
    if (i % 97 == 0) level = static_cast<int>(rng.next() % 3);
    adc[i] = level == 0 ? 0 : level == 1 ? 65535 : static_cast<std::uint16_t>(rng.next());
  }
  const Calibration c = calibration_of(5.0, -3.0);
  const auto out = run("native", image(kReference), c, adc);
  ASSERT_TRUE(out);
  for (std::size_t i = 0; i < adc.size(); ++i) ASSERT_LE(std::abs(out->force_N[i]), 10.0F) << i;
  EXPECT_LE(conformance(*out, c, adc).value, 1.0);
}

TEST(Compensation, OutputDoesNotJumpWhenTheWindowCloses) {
  Decay d{.f_Hz = 2.0, .duration_s = 40.0, .noise_V = 0.0};
  const Record r = decaying_sine(d);
  const auto out = run("native", image(kReference), calibration_of(0.5, 0.15), r.adc);
  ASSERT_TRUE(out);
  const double steepest = 6.2832 * 2.0 * 1.05 * 1e-3;
  for (std::size_t i = 1; i < r.adc.size(); ++i)
    ASSERT_LT(std::abs(static_cast<double>(out->force_N[i]) - out->force_N[i - 1]), 1.2 * steepest + 0.003)
        << i;
}

TEST(Oracle, AgreesWithTheFirmwareAndSeesTwoPercentOfGain) {
  const Record r = decaying_sine({.duration_s = 300.0});
  const Calibration c = calibration_of(0.5, 0.15);
  const auto good = run("native", image(kReference), c, r.adc);
  ASSERT_TRUE(good);
  const Comparison fits = conformance(*good, c, r.adc);
  EXPECT_EQ(fits.n, r.adc.size());
  EXPECT_LT(fits.value, 0.2);
  for (const char* name : {"mutants/gain_pct@2.native.so", "mutants/compensation_off.native.so"}) {
    const auto bad = run("native", image(name), c, r.adc);
    ASSERT_TRUE(bad);
    const Comparison differs = conformance(*bad, c, r.adc);
    EXPECT_GT(differs.value, differs.limit) << name;
  }
}

TEST(Oracle, CountsTheSamplesWhoseFlagsDifferWhereTheForcesAreEqual) {
  const Record r = decaying_sine({.duration_s = 60.0});
  const Calibration c = calibration_of(0.5, 0.15);
  auto out = run("native", image(kReference), c, r.adc);
  ASSERT_TRUE(out);
  for (const std::size_t i : {1234, 1235, 50000}) out->flags[i] ^= kDutHeld;
  const Comparison differs = conformance(*out, c, r.adc);
  EXPECT_EQ(differs.value, 3.0);
  EXPECT_EQ(differs.unit, "samples");
  EXPECT_EQ(differs.limit, 0.0);
  EXPECT_NE(differs.evidence.find("first at sample 1234 (1.234 s)"), std::string::npos) << differs.evidence;
  out->force_N[2000] += 1.0f;
  EXPECT_EQ(conformance(*out, c, r.adc).unit, "LSB") << "a force that differs says more";
}

TEST(NativeLane, MarksItsWayInAndOutOfTheFirmware) {
  FirmwareGuard guard;
  g_firmware_guard = &guard;
  const Record r = decaying_sine({.duration_s = 10.0});
  ASSERT_TRUE(run("native", image(kReference), calibration_of(0.5, 0.15), r.adc, 100));
  g_firmware_guard = nullptr;
  EXPECT_EQ(guard.in_firmware, 0U);
  EXPECT_EQ(guard.sample_index, 10000U);
}

TEST(NativeLane, RefusesAWrongIndexACalibrationOutOfRangeAndAFileThatIsNone) {
  auto dut = make_dut("native");
  ASSERT_TRUE(dut);
  DutSession session;
  session.image = image(kReference);
  ASSERT_TRUE((*dut)->open(session));
  const std::uint16_t adc[1] = {1000};
  float force[1];
  std::uint8_t flags[1];
  EXPECT_EQ((*dut)->process(5, adc, force, flags).error().code, ErrorCode::firmware);
  session.calibration.gain_N_per_V = std::nan("");
  EXPECT_EQ((*dut)->open(session).error().code, ErrorCode::firmware);
  session.image = "/no/such/file";
  const auto missing = (*dut)->open(session);
  EXPECT_EQ(missing.error().code, ErrorCode::usage);
  EXPECT_FALSE(missing.error().hint.empty());
  session.image = std::filesystem::path(FORCEGATE_SOURCE_DIR) / "LICENSE";
  EXPECT_EQ((*dut)->open(session).error().code, ErrorCode::usage);
}

}  // namespace
}  // namespace forcegate::test
