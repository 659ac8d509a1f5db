#include "rigs/emulated/sensor_hook.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/interface/rig.h"

namespace forcegate::emulated {
namespace {

/// Turns the wheel up for half of the record and down again, slowly.
RigBlock ramp(const std::map<std::string, std::string>& options) {
  auto rig = make_rig("emulated", options);
  EXPECT_TRUE(rig) << (rig ? "" : rig.error().to_text());
  RigRecordRequest request;
  request.duration_s = 20.0;
  request.force_high_N = 4.0;
  EXPECT_TRUE((*rig)->begin(request));
  RigBlock block;
  block.resize(20000);
  EXPECT_TRUE((*rig)->command_velocity(0.2));
  EXPECT_TRUE((*rig)->run(10000, block, 0));
  EXPECT_TRUE((*rig)->command_velocity(-0.2));
  EXPECT_TRUE((*rig)->run(10000, block, 10000));
  return block;
}

/// Mean over the way up and down of the code difference at one wheel angle.
double loop_codes(const RigBlock& block) {
  double sum = 0.0;
  int n = 0;
  for (std::size_t i = 3000; i < 9000; i += 100)
    for (std::size_t j = 11000; j < 19000; ++j)
      if (std::abs(block.theta_rad[j] - block.theta_rad[i]) < 1e-4F) {
        sum += static_cast<double>(block.adc[j]) - static_cast<double>(block.adc[i]);
        ++n;
        break;
      }
  EXPECT_GT(n, 20);
  return sum / n;
}

TEST(SensorHook, WithoutStrengthTheSensorIsTheOrdinaryOne) {
  const RigBlock ordinary = ramp({}), hooked = ramp({{"hidden", "hysteresis:0"}});
  EXPECT_EQ(ordinary.adc, hooked.adc);
  EXPECT_EQ(ordinary.force_ref_N, hooked.force_ref_N);
}

TEST(SensorHook, HysteresisWidensTheLoopOfTheSensorAndNotOfTheReference) {
  const RigBlock ordinary = ramp({}), hooked = ramp({{"hidden", "hysteresis:strong"}});
  EXPECT_EQ(ordinary.force_ref_N, hooked.force_ref_N);
  EXPECT_GT(std::abs(loop_codes(hooked)), 2.0 * std::abs(loop_codes(ordinary)));
  EXPECT_GT(std::abs(loop_codes(hooked)), std::abs(loop_codes(ramp({{"hidden", "hysteresis:weak"}}))));
}

TEST(SensorHook, CreepGrowsWhileTheLoadStays) {
  auto rig = make_rig("emulated", {{"hidden", "creep:strong"}, {"noise", "off"}});
  auto plain = make_rig("emulated", {{"noise", "off"}});
  ASSERT_TRUE(rig);
  ASSERT_TRUE(plain);
  const auto growth = [](Rig& r) {
    RigRecordRequest request;
    request.duration_s = 200.0;
    request.force_low_N = request.force_high_N = 3.0;
    EXPECT_TRUE(r.begin(request));
    RigBlock block;
    block.resize(200000);
    EXPECT_TRUE(r.run(200000, block, 0));
    return static_cast<double>(block.adc.back()) - static_cast<double>(block.adc[10000]);
  };
  EXPECT_GT(growth(**rig), growth(**plain) + 100.0);
}

TEST(SensorHook, TheSameRequestGivesTheSameBits) {
  EXPECT_EQ(ramp({{"hidden", "creep"}}).adc, ramp({{"hidden", "creep:medium"}}).adc);
}

TEST(SensorHook, WrongNamesAndStrengthsAreRefusedWithAHint) {
  for (const char* text : {"rust", "hysteresis:huge", "creep:-1", "creep:1.5", ""}) {
    const auto rig = make_rig("emulated", {{"hidden", text}});
    ASSERT_FALSE(rig) << text;
    EXPECT_EQ(rig.error().code, ErrorCode::config);
    EXPECT_FALSE(rig.error().hint.empty());
  }
}

}  // namespace
}  // namespace forcegate::emulated
