#include "hil/rig/safety_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

struct Bench {
  testing::FakeRig rig;
  RigBlock block;
  Bench() { block.resize(1000); }
};

TEST(SafetyGate, clips_a_velocity_to_the_limit_of_the_drive) {
  Bench b;
  SafetyGate gate(b.rig, {});
  ASSERT_TRUE(gate.begin({}));
  EXPECT_EQ(*gate.command(1e6), 60.0);
  EXPECT_EQ(*gate.command(-5.0), 0.0) << "the wheel stands at its lower end";
  EXPECT_EQ(gate.report().clipped_commands, 2u);
}

TEST(SafetyGate, clips_to_the_lower_velocity_of_plan_and_rig) {
  for (const auto& [of_plan, cut] : {std::pair{200.0, 60.0}, {10.0, 10.0}}) {
    Bench b;
    SafetyGate gate(b.rig, {.velocity_max_rad_per_s = of_plan});
    ASSERT_TRUE(gate.begin({}));
    EXPECT_EQ(*gate.command(1e6), cut);
  }
}

TEST(SafetyGate, stops_for_good_when_the_force_exceeds_the_limit) {
  Bench b;
  SafetyGate gate(b.rig, {.force_max_N = 2.0});
  ASSERT_TRUE(gate.begin({}));
  ASSERT_TRUE(gate.command(60.0));
  ASSERT_TRUE(gate.run(1000, b.block, 0));
  EXPECT_EQ(gate.report().reason, StopReason::force_limit);
  EXPECT_GT(gate.report().force_N, 2.0);
  EXPECT_LT(gate.report().force_N, 2.3);
  EXPECT_GE(b.rig.parked, 1);
  EXPECT_EQ(*gate.run(10, b.block, 0), 0u);
  EXPECT_EQ(*gate.command(1.0), 0.0);
}

TEST(SafetyGate, goes_on_blind_for_a_quarter_of_a_second_at_any_rate) {
  Bench b;
  b.rig.change_info().rate_Hz = 100.0;
  b.rig.spoil = [](std::size_t row, double t_s, RigBlock& block) {
    if (t_s > 0.995) block.force_ref_N[row] = std::nanf("");
  };
  SafetyGate gate(b.rig, {});
  ASSERT_TRUE(gate.begin({}));
  ASSERT_TRUE(gate.run(1000, b.block, 0));
  EXPECT_EQ(gate.report().reason, StopReason::reference_lost);
  EXPECT_NEAR(gate.report().t_s, 1.25, 0.02);
}

TEST(SafetyGate, stops_when_the_sensor_is_pulled_beyond_the_limit) {
  Bench b;
  b.rig.spoil = [](std::size_t row, double t_s, RigBlock& block) { block.force_ref_N[row] = t_s < 0.5 ? -1.9f : -2.1f; };
  SafetyGate gate(b.rig, {.force_max_N = 2.0});
  ASSERT_TRUE(gate.begin({}));
  ASSERT_TRUE(gate.run(1000, b.block, 0));
  EXPECT_EQ(gate.report().reason, StopReason::force_limit);
  EXPECT_NEAR(gate.report().t_s, 0.5, 0.002);
  EXPECT_GE(b.rig.parked, 1);
}

TEST(SafetyGate, stops_when_a_command_is_not_a_number) {
  Bench b;
  SafetyGate gate(b.rig, {});
  ASSERT_TRUE(gate.begin({}));
  ASSERT_TRUE(gate.command(std::nan("")));
  EXPECT_EQ(gate.report().reason, StopReason::bad_command);
}

TEST(SafetyGate, forgives_a_short_loss_of_the_reference_and_stops_on_a_long_one) {
  for (const int lost : {249, 250}) {
    Bench b;
    b.rig.spoil = [lost](std::size_t row, double t_s, RigBlock& block) {
      const auto sample = std::lround(t_s * 1000.0);
      if (sample >= 100 && sample < 100 + lost) block.status[row] |= kRigReferenceSaturated;
    };
    SafetyGate gate(b.rig, {.reference_lost_samples = 250});
    ASSERT_TRUE(gate.begin({}));
    ASSERT_TRUE(gate.run(1000, b.block, 0));
    EXPECT_EQ(gate.report().reason, lost == 250 ? StopReason::reference_lost : StopReason::none) << lost;
  }
}

TEST(SafetyGate, parks_the_rig_when_it_goes_out_of_scope) {
  Bench b;
  { SafetyGate gate(b.rig, {}); }
  EXPECT_EQ(b.rig.parked, 1);
}

}  // namespace
}  // namespace forcegate
