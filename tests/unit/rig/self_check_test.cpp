#include "hil/rig/self_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

// Thirty seconds of a moving wheel with an ATI of 10 mN noise in steps of 25 mN.
std::vector<Check> checks_of(testing::FakeRig& rig) {
  rig.change_info().reference_noise_N = 0.01;
  Rng rng(5, "noise");
  const auto spoil = rig.spoil;
  rig.spoil = [&](std::size_t row, double t_s, RigBlock& block) {
    float& f = block.force_ref_N[row];
    f = std::round((f + static_cast<float>(rng.normal(0.0, 0.01))) / 0.025f) * 0.025f;
    if (spoil) spoil(row, t_s, block);
  };
  RigRecordRequest request;
  request.force_low_N = 1.0;
  EXPECT_TRUE(rig.begin(request));
  RigWitness witness;
  witness.begin(rig.info());
  RigBlock block;
  block.resize(100);
  std::vector<float> told(100);
  for (int k = 0; k < 300; ++k) {
    const double velocity = (k / 10) % 2 == 0 ? 1.0 : -1.0;
    EXPECT_TRUE(rig.command_velocity(velocity));
    EXPECT_TRUE(rig.run(100, block, 0));
    std::fill(told.begin(), told.end(), static_cast<float>(velocity));
    witness.push(block, 100, told.data());
  }
  return self_check(rig.info(), witness.finish());
}

std::string unsound(testing::FakeRig& rig) {
  const auto checks = checks_of(rig);
  const Check* bad = first_unsound(checks);
  if (bad != nullptr) {
    EXPECT_EQ(bad->verdict, Verdict::rig_error);
    EXPECT_FALSE(bad->evidence.empty());
  }
  return bad == nullptr ? "" : bad->id;
}

TEST(SelfCheck, passes_a_sound_rig) {
  testing::FakeRig rig;
  EXPECT_EQ(unsound(rig), "");
}

TEST(SelfCheck, blames_the_reference_for_saturation) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double, RigBlock& b) {
    if (b.force_ref_N[row] > 1.5f) b.status[row] |= kRigReferenceSaturated;
  };
  EXPECT_EQ(unsound(rig), "rig_reference_valid");
}

TEST(SelfCheck, sees_a_frozen_reference) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (t_s > 15.0) b.force_ref_N[row] = 1.25f;
  };
  EXPECT_EQ(unsound(rig), "rig_reference_alive");
}

TEST(SelfCheck, sees_an_offset_of_the_reference_by_the_spring_witness) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double, RigBlock& b) { b.force_ref_N[row] += 0.3f; };
  EXPECT_EQ(unsound(rig), "rig_spring_witness");
}

TEST(SelfCheck, sees_a_reference_with_a_wrong_gain) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double, RigBlock& b) {
    b.force_ref_N[row] = 1.2f * b.force_ref_N[row] - 0.2f;
  };
  EXPECT_NE(unsound(rig), "");
}

TEST(SelfCheck, sees_noise_far_above_what_the_reference_declares) {
  testing::FakeRig rig;
  auto rng = std::make_shared<Rng>(9);
  rig.spoil = [rng](std::size_t row, double, RigBlock& b) {
    b.force_ref_N[row] += static_cast<float>(rng->normal(0.0, 0.1));
  };
  EXPECT_EQ(unsound(rig), "rig_reference_noise");
}

TEST(SelfCheck, sees_a_stuck_converter_bit) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double, RigBlock& b) { b.adc[row] |= 0x0010; };
  EXPECT_EQ(unsound(rig), "rig_adc");
}

TEST(SelfCheck, blames_the_sensor_that_came_unplugged) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (t_s > 15.0) b.adc[row] = 0;
  };
  const auto checks = checks_of(rig);
  ASSERT_NE(first_unsound(checks), nullptr);
  EXPECT_EQ(first_unsound(checks)->id, "rig_sensor");
  EXPECT_EQ(first_unsound(checks)->blame, Blame::sensor);
}

TEST(SelfCheck, sees_lost_samples_and_gaps_of_time) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (std::fmod(t_s, 0.5) < 0.0005) b.status[row] |= kRigSampleLost;
  };
  EXPECT_EQ(unsound(rig), "rig_samples");
}

TEST(SelfCheck, does_not_pass_a_rig_that_gave_nothing) {
  RigInfo info;
  const auto checks = self_check(info, {});
  ASSERT_NE(first_unsound(checks), nullptr);
}

}  // namespace
}  // namespace forcegate
