#include "rigs/emulated/faults.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/emulated/maxima.h"

namespace forcegate::test {
namespace {

RigBlock play_with(std::map<std::string, double> faults) {
  BenchRun bench;
  bench.request.faults = std::move(faults);
  return bench.play(*stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}, {"duration_s", 10.0}}));
}

TEST(Faults, saturated_reference_stops_at_its_level_and_says_so) {
  const RigBlock b = play_with({{"reference_saturated", 2.0}});
  std::size_t flagged = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    EXPECT_LE(b.force_ref_N[i], 2.001F);
    flagged += (b.status[i] & kRigReferenceSaturated) != 0;
  }
  EXPECT_GT(flagged, b.size() / 3);
  EXPECT_LT(flagged, b.size());
}

TEST(Faults, offset_moves_the_reference_and_nothing_else) {
  const RigBlock sound = play_with({}), b = play_with({{"reference_offset", 0.3}});
  double mean = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i)
    mean += static_cast<double>(b.force_ref_N[i] - sound.force_ref_N[i]) / static_cast<double>(b.size());
  EXPECT_NEAR(mean, 0.3, 0.002);
  EXPECT_EQ(b.adc, sound.adc);
}

TEST(Faults, frozen_reference_repeats_its_reading_from_the_instant_on) {
  const RigBlock b = play_with({{"reference_frozen", 4.0}});
  for (std::size_t i = 4000; i < b.size(); ++i) ASSERT_EQ(b.force_ref_N[i], b.force_ref_N[4000]);
  EXPECT_NE(b.force_ref_N[3000], b.force_ref_N[4000]);
}

// A record does not depend on the one before it: whatever a fault holds is held from its own beginning on.
TEST(Faults, that_hold_a_value_forget_it_with_their_record) {
  const auto profile = stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}, {"duration_s", 10.0}});
  for (const auto& [fault, magnitude] : {std::pair{"sensor_stale", 0.9}, {"reference_stale", 0.9}, {"reference_frozen", 0.0}}) {
    BenchRun before, bench;
    bench.request.faults = {{fault, magnitude}};
    const auto used = value_or_abort(make_rig("emulated", {})), fresh = value_or_abort(make_rig("emulated", {}));
    before.request = bench.request;
    before.request.record = 7;
    before.play(*used, *profile);
    const RigBlock after = bench.play(*used, *profile), alone = bench.play(*fresh, *profile);
    EXPECT_EQ(after.adc, alone.adc) << fault;
    EXPECT_EQ(after.force_ref_N, alone.force_ref_N) << fault;
    // read as the record begins
    ASSERT_TRUE(used->begin(bench.request));
    const auto unused = value_or_abort(make_rig("emulated", {}));
    ASSERT_TRUE(unused->begin(bench.request));
    EXPECT_EQ(used->reference_zero().mean_N, unused->reference_zero().mean_N) << fault;
  }
}

TEST(Faults, stalled_motor_stands_still_and_reports_a_drive_fault) {
  const RigBlock b = play_with({{"motor_stalled", 4.3}});
  for (std::size_t i = 4310; i < b.size(); ++i) ASSERT_EQ(b.theta_rad[i], b.theta_rad[4310]);
  EXPECT_TRUE(b.status.back() & kRigMotorFault);
  EXPECT_FALSE(b.status[4000] & kRigMotorFault);
}

TEST(Faults, unplugged_sensor_reads_zero) {
  const RigBlock b = play_with({{"sensor_unplugged", 4.0}});
  EXPECT_GT(b.adc[3999], 0);
  for (std::size_t i = 4000; i < b.size(); ++i) ASSERT_EQ(b.adc[i], 0);
  EXPECT_TRUE(b.status.back() & kRigAdcRail);
}

TEST(Faults, stuck_bit_is_always_one_and_the_others_live) {
  const RigBlock sound = play_with({}), b = play_with({{"adc_stuck_bit", 13.0}});
  for (std::size_t i = 0; i < b.size(); ++i) ASSERT_EQ(b.adc[i], sound.adc[i] | (1 << 13));
  EXPECT_NE(b.adc, sound.adc);
}

TEST(Faults, lost_samples_are_marked_and_carry_no_reference) {
  const RigBlock b = play_with({{"sample_loss", 0.02}});
  std::size_t lost = 0;
  for (std::size_t i = 1; i < b.size(); ++i) {
    if (!(b.status[i] & kRigSampleLost)) continue;
    ++lost;
    EXPECT_TRUE(std::isnan(b.force_ref_N[i]));
    EXPECT_EQ(b.adc[i], b.adc[i - 1]);
  }
  EXPECT_NEAR(static_cast<double>(lost) / static_cast<double>(b.size()), 0.02, 0.006);
}

TEST(Faults, truncated_record_ends_early) { EXPECT_EQ(play_with({{"truncated", 3.0}}).size(), 3000U); }

TEST(Faults, unknown_names_and_magnitudes_are_refused_with_a_suggestion) {
  const auto unknown = emulated::parse_faults({{"motor_staled", 1.0}});
  ASSERT_FALSE(unknown.has_value());
  EXPECT_EQ(unknown.error().code, ErrorCode::config);
  EXPECT_NE(unknown.error().hint.find("motor_stalled"), std::string::npos);
  EXPECT_FALSE(emulated::parse_faults({{"sample_loss", 1.5}}).has_value());
  EXPECT_FALSE(emulated::parse_faults({{"adc_stuck_bit", std::nan("")}}).has_value());
  for (const auto& kind : emulated::fault_kinds()) EXPECT_FALSE(kind.doc.empty());
}

TEST(Faults, a_magnitude_that_leaves_the_rig_sound_is_no_fault) {
  for (const char* name : {"reference_offset", "reference_drift", "sample_loss", "spring_slipped", "clock_skew", "head_motion"}) {
    const auto none = emulated::parse_faults({{name, 0.0}});
    ASSERT_FALSE(none.has_value()) << name;
    EXPECT_NE(none.error().text.find("changes nothing"), std::string::npos) << none.error().text;
  }
  EXPECT_FALSE(emulated::parse_faults({{"reference_gain", 1.0}}).has_value());
  EXPECT_TRUE(emulated::parse_faults({{"motor_stalled", 0.0}, {"adc_stuck_bit", 0.0}, {"transient", 1.0}, {"wrong_calibration", 1.0}}).has_value());
}

}  // namespace
}  // namespace forcegate::test
