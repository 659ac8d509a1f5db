// Three streams of their own pace become rows: what is missing, late or over is told, and never guessed.

#include "hil/rig/bench/row_assembler.h"

#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

constexpr double kPeriod_s = 0.001, kNear_N = 1e-6;

class RowAssemblerTest : public ::testing::Test {
 protected:
  RowAssemblerTest() : rows_({1000.0, 16, 0.0, 3.0, 0.1, 0.05}) {
    block_.resize(2000);
    rows_.begin(0.0, 0.0);
    rows_.begin_block(0);
  }

  // Sample i is measured at its own instant, a period after the one before it.
  static double measured_s(std::size_t i) { return kPeriod_s * static_cast<double>(i + 1); }
  static std::uint16_t code(std::size_t i) { return static_cast<std::uint16_t>(1000 + i); }

  // What the board sends of samples [from, until), read at now_s.
  void frame(std::size_t from, std::size_t until, double now_s) {
    for (std::size_t i = from; i < until; ++i) ASSERT_TRUE(rows_.take({static_cast<std::uint32_t>(i), code(i), 0.5F, 0}, now_s));
  }
  // Every sample as soon as it is measured.
  void prompt(std::size_t from, std::size_t until) {
    for (std::size_t i = from; i < until; ++i) frame(i, i + 1, measured_s(i));
  }
  // One newton a second, a reading at every sample.
  void readings(std::size_t from, std::size_t until) {
    std::vector<ReferenceReading> fresh;
    for (std::size_t i = from; i < until; ++i) fresh.push_back({measured_s(i), static_cast<float>(measured_s(i)), 0});
    rows_.take(fresh);
  }
  // Fills rows of the block until nothing waits.
  void fill(std::size_t from) {
    for (std::size_t row = from; rows_.waiting() > 0; ++row) rows_.fill(block_, row, 0.0);
  }

  RowAssembler rows_;
  RigBlock block_;
};

TEST_F(RowAssemblerTest, AFrameOfSamplesIsPlacedByItsLast) {
  readings(0, 12);
  frame(0, 10, measured_s(9));
  ASSERT_EQ(rows_.waiting(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const auto sample = rows_.fill(block_, i, 0.0);
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->index, i);
    EXPECT_EQ(block_.adc[i], code(i));
    EXPECT_EQ(block_.status[i], 0);
    EXPECT_DOUBLE_EQ(block_.t_s[i], kPeriod_s * static_cast<double>(i));
    EXPECT_NEAR(block_.force_ref_N[i], measured_s(i), kNear_N);
  }
  EXPECT_EQ(rows_.index(), 10U);
  EXPECT_NEAR(rows_.due_s(5), measured_s(14), 1e-12);
}

TEST_F(RowAssemblerTest, AGapIsRowsThatAreLostAndMovesNoOther) {
  readings(0, 10);
  prompt(0, 3);
  prompt(5, 8);
  ASSERT_EQ(rows_.waiting(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    const bool lost = i == 3 || i == 4;
    const auto sample = rows_.fill(block_, i, 0.0);
    EXPECT_EQ(sample.has_value(), !lost) << i;
    EXPECT_EQ((block_.status[i] & kRigSampleLost) != 0, lost) << i;
    EXPECT_EQ(block_.adc[i], lost ? code(2) : code(i)) << i;
    EXPECT_DOUBLE_EQ(block_.t_s[i], kPeriod_s * static_cast<double>(i));
    EXPECT_NEAR(block_.force_ref_N[i], measured_s(i), kNear_N) << i;
  }
}

TEST_F(RowAssemblerTest, AGapLongerThanABoardMayBeSilentIsDamage) {
  prompt(0, 3);
  EXPECT_TRUE(rows_.take({203, 1, 0.0F, 0}, 0.3));
  const auto refused = rows_.take({405, 1, 0.0F, 0}, 0.5);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::device);
  EXPECT_EQ(refused.error().text, "the board's sample 204 is followed by sample 405");
}

// Less late than what the arrival clock takes for a loss.
TEST_F(RowAssemblerTest, ALateFrameIsOfWhenItWasMeasured) {
  readings(0, 150);
  prompt(0, 100);
  fill(0);
  EXPECT_NEAR(rows_.due_s(10), measured_s(109), 1e-12);
  frame(100, 110, measured_s(109) + 0.01);
  fill(100);
  for (std::size_t i = 100; i < 110; ++i) EXPECT_NEAR(block_.force_ref_N[i], measured_s(i), kNear_N) << i;
}

TEST_F(RowAssemblerTest, ALateReadingTakesThePlaceOfTheOneThatStoodIn) {
  readings(0, 10);
  prompt(0, 100);
  fill(0);
  rows_.refine(block_, 100);
  EXPECT_NEAR(block_.force_ref_N[40], measured_s(9), kNear_N);
  EXPECT_EQ(block_.status[40], 0);
  EXPECT_TRUE(std::isnan(block_.force_ref_N[80])) << "the last reading is too old to stand in";
  EXPECT_EQ(block_.status[80], kRigReferenceFault);
  readings(10, 101);
  rows_.refine(block_, 100);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_NEAR(block_.force_ref_N[i], measured_s(i), kNear_N) << i;
    EXPECT_EQ(block_.status[i], 0) << i;
  }
}

TEST_F(RowAssemblerTest, OnlyTheBlockThatIsFilledIsLookedAtAgain) {
  readings(0, 10);
  prompt(0, 20);
  fill(0);
  RigBlock next;
  next.resize(20);
  rows_.begin_block(0);
  prompt(20, 40);
  for (std::size_t row = 0; row < 20; ++row) rows_.fill(next, row, 0.0);
  readings(10, 41);
  rows_.refine(next, 20);
  EXPECT_NEAR(next.force_ref_N[0], measured_s(20), kNear_N);
  EXPECT_NEAR(block_.force_ref_N[19], measured_s(9), kNear_N);
}

TEST_F(RowAssemblerTest, AtTheEndOfTheStreamNoRowIsMadeUp) {
  readings(0, 20);
  prompt(0, 15);
  fill(0);
  EXPECT_EQ(rows_.index(), 15U);
  readings(20, 500);
  EXPECT_EQ(rows_.waiting(), 0U) << "the reference goes on alone";
}

TEST_F(RowAssemblerTest, ANewStreamHasNothingOfTheOneBefore) {
  readings(0, 20);
  rows_.take(MotorState{0.01, 1.0, 0.0, true, true, 7});
  prompt(0, 15);
  fill(0);
  prompt(15, 18);
  rows_.begin(10.0, 2.0);
  rows_.begin_block(0);
  EXPECT_EQ(rows_.index(), 0U);
  EXPECT_EQ(rows_.waiting(), 0U);
  EXPECT_NEAR(rows_.due_s(1), 10.0 + kPeriod_s, 1e-12);
  ASSERT_TRUE(rows_.take({1, 77, 0.0F, 0}, 10.002));
  EXPECT_FALSE(rows_.fill(block_, 0, 0.0));
  EXPECT_EQ(block_.adc[0], 0) << "no code of another stream stands in";
  EXPECT_EQ(block_.status[0], kRigSampleLost | kRigReferenceFault);
  EXPECT_TRUE(std::isnan(block_.force_ref_N[0]));
  EXPECT_EQ(block_.theta_rad[0], 2.0F);
  ASSERT_TRUE(rows_.fill(block_, 1, 0.0));
  EXPECT_EQ(block_.adc[1], 77);
}

TEST_F(RowAssemblerTest, RailsStopsAndFaultsAreOfTheRow) {
  readings(0, 10);
  ASSERT_TRUE(rows_.take({0, 65535, 0.0F, 0}, measured_s(0)));
  ASSERT_TRUE(rows_.take({1, 0, 0.0F, 0}, measured_s(1)));
  rows_.fill(block_, 0, 1.0);
  EXPECT_EQ(block_.status[0], kRigAdcRail);
  rows_.fill(block_, 1, -1.0);
  EXPECT_EQ(block_.status[1], kRigAdcRail | kRigTravelStop) << "at the lower end, told to go below";
  rows_.take(MotorState{0.0025, 3.0, 0.0, true, true, 0});
  prompt(2, 4);
  rows_.fill(block_, 2, 1.0);
  EXPECT_EQ(block_.status[2], kRigMotorFault | kRigTravelStop);
  rows_.fill(block_, 3, -1.0);
  EXPECT_EQ(block_.status[3], kRigMotorFault);
}

}  // namespace
}  // namespace forcegate
