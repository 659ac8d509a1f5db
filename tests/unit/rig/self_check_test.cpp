#include "hil/rig/self_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/base/rng.h"
#include "hil/rig/rig_witness.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

// Thirty seconds of a moving wheel with an ATI of 10 mN noise in steps of 25 mN.
RigObservation observe(testing::FakeRig& rig, RigInfo& info, const ReferenceZero& zero) {
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
  witness.zero_before(zero);
  witness.zero_after(zero);
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
  info = rig.info();
  return witness.finish();
}

std::vector<Check> checks_of(testing::FakeRig& rig) {
  RigInfo info;
  const RigObservation seen = observe(rig, info, {});
  return self_check(info, seen);
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

TEST(SelfCheck, blames_nobody_for_what_passes) {
  testing::FakeRig rig;
  for (const Check& c : checks_of(rig)) {
    ASSERT_EQ(c.verdict, Verdict::pass) << c.id;
    for (const char* blame : {"a known mass tells", "are not as set", "or a late reading", "zero of the ATI"}) EXPECT_EQ(c.evidence.find(blame), std::string::npos) << c.id << ": " << c.evidence;
  }
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

TEST(SelfCheck, does_not_blame_the_reference_for_readings_that_a_late_harness_did_not_fetch) {
  const auto blamed = [](const char* late_share, std::uint16_t status) {
    testing::FakeRig rig;
    rig.change_info().details[kLateTickShare] = late_share;
    rig.spoil = [status](std::size_t row, double t_s, RigBlock& b) {
      if (t_s >= 10.0 && t_s < 10.2) b.status[row] |= status;
    };
    for (const Check& c : checks_of(rig))
      if (c.id == "rig_reference_valid") {
        EXPECT_EQ(c.verdict, Verdict::rig_error);
        EXPECT_EQ(c.blame == Blame::rig, c.evidence.find("harness's own ticks") != std::string::npos) << c.evidence;
        return c.blame;
      }
    return Blame::none;
  };
  EXPECT_EQ(blamed("0.010000", kRigReferenceFault), Blame::rig);
  EXPECT_EQ(blamed("0.001000", kRigReferenceFault), Blame::reference) << "more is missing than the harness was late";
  EXPECT_EQ(blamed("0.010000", kRigReferenceSaturated), Blame::reference) << "an overload is no lateness";
}

TEST(SelfCheck, names_the_call_that_held_the_harness_up_instead_of_the_reference) {
  for (const auto& [call, blame] : {std::pair{"polling the sensor board took 0.700 s", Blame::rig}, std::pair{"polling the ATI took 0.700 s", Blame::reference}}) {
    testing::FakeRig rig;
    rig.change_info().details[kLateTickShare] = "0.000200";  // one tick, of most of a second
    rig.change_info().details[kLateTimeShare] = "0.150000";
    rig.change_info().details[kSlowestCall] = call;
    rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
      if (t_s >= 10.0 && t_s < 10.7) b.status[row] |= kRigReferenceFault;
    };
    for (const Check& c : checks_of(rig))
      if (c.id == "rig_reference_valid") {
        EXPECT_EQ(c.verdict, Verdict::rig_error);
        EXPECT_EQ(c.blame, blame) << call;
        EXPECT_EQ(c.evidence.find("nobody fetched them: polling the sensor board took 0.700 s") != std::string::npos, blame == Blame::rig) << c.evidence;
      }
  }
}

TEST(SelfCheck, counts_a_row_without_a_reading_once_whatever_says_so) {
  testing::FakeRig rig;
  std::size_t spoiled = 0;
  rig.spoil = [&](std::size_t row, double t_s, RigBlock& b) {
    if (!(t_s >= 10.0 && t_s < 10.2)) return;
    b.force_ref_N[row] = std::nanf("");
    b.status[row] |= kRigReferenceFault | (t_s < 10.1 ? kRigReferenceSaturated : 0);
    ++spoiled;
  };
  for (const Check& c : checks_of(rig))
    if (c.id == "rig_reference_valid") {
      EXPECT_NE(c.evidence.find("0 samples saturated, " + std::to_string(spoiled) + " with an error, 0 without a value"), std::string::npos) << c.evidence;
    }
  EXPECT_GT(spoiled, 0U);
}

TEST(SelfCheck, counts_as_saturated_what_the_reference_says_is_with_a_value_or_without) {
  for (const bool with_value : {true, false}) {
    testing::FakeRig rig;
    std::size_t spoiled = 0;
    rig.spoil = [&](std::size_t row, double t_s, RigBlock& b) {
      if (!(t_s >= 10.0 && t_s < 10.2)) return;
      if (!with_value) b.force_ref_N[row] = std::nanf("");
      b.status[row] |= kRigReferenceSaturated;
      ++spoiled;
    };
    for (const Check& c : checks_of(rig))
      if (c.id == "rig_reference_valid") {
        EXPECT_EQ(c.verdict, Verdict::rig_error);
        EXPECT_EQ(c.blame, Blame::reference);
        EXPECT_NE(c.evidence.find(std::to_string(spoiled) + " samples saturated, 0 with an error, 0 without a value"), std::string::npos) << c.evidence;
      }
    EXPECT_GT(spoiled, 0U);
  }
}

TEST(SelfCheck, sees_a_frozen_reference) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (t_s > 15.0) b.force_ref_N[row] = 1.25f;
  };
  EXPECT_EQ(unsound(rig), "rig_reference_alive");
}

TEST(SelfCheck, tells_of_a_reference_that_stands_still_at_zero_that_the_contact_may_have_opened) {
  for (const bool at_zero : {true, false}) {
    testing::FakeRig rig;
    rig.spoil = [&](std::size_t row, double t_s, RigBlock& b) {
      if (t_s > 15.0 && t_s < 17.0) b.force_ref_N[row] = at_zero ? 0.0f : 1.25f;
    };
    for (const Check& c : checks_of(rig))
      if (c.id == "rig_reference_alive") {
        EXPECT_EQ(c.evidence.find("where the contact opens") != std::string::npos, at_zero) << c.evidence;
      }
  }
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

// A film that has lost most of its gain, on 8 bits: more than the ATI's witness needs passes within one step of the converter.
TEST(SelfCheck, a_coarse_converter_that_stays_on_one_code_for_a_step_is_alive_and_a_dead_one_is_not) {
  for (const bool dead : {false, true}) {
    testing::FakeRig rig;
    rig.gain_N_per_V = 3.0;
    rig.change_info().adc_bits = 8;
    rig.spoil = [dead](std::size_t row, double t_s, RigBlock& b) { b.adc[row] = dead && t_s > 15.0 ? 20 : static_cast<std::uint16_t>(b.adc[row] / 257); };
    const auto checks = checks_of(rig);
    const auto at = std::find_if(checks.begin(), checks.end(), [](const Check& c) { return c.id == "rig_sensor"; });
    ASSERT_NE(at, checks.end());
    EXPECT_EQ(at->verdict, dead ? Verdict::rig_error : Verdict::pass) << at->evidence;
  }
}

TEST(SelfCheck, sees_lost_samples_and_gaps_of_time) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (std::fmod(t_s, 0.5) < 0.0005) b.status[row] |= kRigSampleLost;
  };
  EXPECT_EQ(unsound(rig), "rig_samples");
}

TEST(SelfCheck, an_unloaded_reading_tells_the_reference_s_zero_from_a_preload) {
  const auto blamed = [](double zero_N) {
    testing::FakeRig rig;
    rig.spoil = [](std::size_t row, double, RigBlock& b) { b.force_ref_N[row] += 0.25f; };
    RigInfo info;
    const RigObservation seen = observe(rig, info, {zero_N, 0.0, 1000});
    for (const Check& c : self_check(info, seen))
      if (c.id == "rig_spring_witness") return c.blame;
    return Blame::none;
  };
  EXPECT_EQ(blamed(0.25), Blame::reference);
  EXPECT_EQ(blamed(0.0), Blame::rig);
}

TEST(SelfCheck, a_small_zero_error_is_seen_without_load_although_the_spring_does_not_show_it) {
  testing::FakeRig rig;
  RigInfo info;
  const RigObservation seen = observe(rig, info, {0.04, 0.0, 1000});
  const auto checks = self_check(info, seen);
  ASSERT_NE(first_unsound(checks), nullptr);
  EXPECT_EQ(first_unsound(checks)->id, "rig_reference_zero");
  EXPECT_EQ(first_unsound(checks)->blame, Blame::reference);
}

TEST(SelfCheck, no_spring_explains_a_reference_that_looks_along_another_axis) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double, RigBlock& b) { b.force_ref_N[row] *= 0.2f; };
  for (const Check& c : checks_of(rig))
    if (c.verdict != Verdict::pass) {
      EXPECT_EQ(c.blame, Blame::reference) << c.id;
    }
}

TEST(SelfCheck, a_wheel_that_leaves_its_command_is_the_rig_s_fault_and_the_drive_s_own_lag_is_not) {
  testing::FakeRig rippling;
  rippling.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    b.theta_rad[row] += 0.06f * static_cast<float>(std::sin(20.0 * t_s));
  };
  bool following = false;
  for (const Check& c : checks_of(rippling))
    following |= c.id == "rig_following" && c.verdict == Verdict::rig_error;
  EXPECT_TRUE(following);
  testing::FakeRig lagging;
  float behind = -1.0f;
  lagging.spoil = [&](std::size_t row, double, RigBlock& b) {
    behind = behind < 0.0f ? b.theta_rad[row] : behind + 0.1f * (b.theta_rad[row] - behind);
    b.theta_rad[row] = behind;
  };
  for (const Check& c : checks_of(lagging))
    if (c.id == "rig_following") {
      EXPECT_EQ(c.verdict, Verdict::pass) << c.evidence;
    }
}

// What the firmware's answer makes of the command is not the wheel's fault: a bench acts one control period late.
TEST(SelfCheck, a_command_that_jumps_to_and_fro_is_followed_as_well_as_a_late_drive_can) {
  testing::FakeRig rig;
  RigRecordRequest request;
  request.force_low_N = 1.0;
  ASSERT_TRUE(rig.begin(request));
  RigWitness witness;
  witness.begin(rig.info());
  RigBlock block;
  block.resize(10);
  Rng rng(7, "chatter");
  double before = 0.0, last = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double draw = 3.0 * rng.normal(0.0, 1.0), velocity = draw - last;  // goes to and fro about one angle
    last = draw;
    ASSERT_TRUE(rig.command_velocity(before));
    ASSERT_TRUE(rig.run(10, block, 0));
    const std::vector<float> told(10, static_cast<float>(velocity));
    before = velocity;
    witness.push(block, 10, told.data());
  }
  const RigObservation seen = witness.finish();
  EXPECT_GT(seen.following_rad, 0.02);
  for (const Check& c : self_check(rig.info(), seen))
    if (c.id == "rig_following") {
      EXPECT_EQ(c.verdict, Verdict::pass) << c.evidence;
    }
}

TEST(SelfCheck, sees_a_clock_that_runs_fast_jumps_or_leaves_a_hole) {
  const auto blame = [](std::function<double(double)> clock) {
    testing::FakeRig rig;
    rig.spoil = [=](std::size_t row, double t_s, RigBlock& b) { b.t_s[row] = clock(t_s); };
    const auto checks = checks_of(rig);
    const Check* bad = first_unsound(checks);
    return bad == nullptr ? Blame::none : bad->blame;
  };
  EXPECT_EQ(blame([](double t) { return t; }), Blame::none);
  EXPECT_EQ(blame([](double t) { return 1.01 * t; }), Blame::link);
  EXPECT_EQ(blame([](double t) { return t > 12.0 ? t + 0.2 : t; }), Blame::link);
}

TEST(SelfCheck, sees_readings_that_come_late) {
  testing::FakeRig rig;
  std::vector<float> line(40, 1.0f);
  std::size_t at = 0;
  rig.spoil = [&](std::size_t row, double, RigBlock& b) {
    std::swap(b.force_ref_N[row], line[at++ % line.size()]);
  };
  bool late = false;
  for (const Check& c : checks_of(rig)) {
    late |= c.id == "rig_reference_lag" && c.verdict == Verdict::rig_error;
    if (c.verdict != Verdict::pass) {
      EXPECT_EQ(c.blame, Blame::reference) << c.id;
    }
  }
  EXPECT_TRUE(late);
}

// Play shows as a lag of ATI and sensor behind the shaft; the sensor's own lag stands beside it.
TEST(SelfCheck, a_little_play_between_shaft_and_wheel_is_the_rig_s) {
  RigInfo info;
  info.can_move = true;
  info.geometry.eccentricity_mm = 5.0;
  RigObservation seen;
  seen.samples = seen.spring_samples = 60000;
  seen.zero_start_N = seen.zero_end_N = 0.0;
  seen.sensor_lag_s = 0.0105;
  const auto blamed = [&](double lag_s) {
    seen.reference_lag_s = lag_s;
    for (const Check& c : self_check(info, seen))
      if (c.id == "rig_reference_lag") return c.blame;
    return Blame::harness;
  };
  EXPECT_EQ(blamed(0.0048), Blame::none);
  EXPECT_EQ(blamed(0.0063), Blame::rig);
  EXPECT_EQ(blamed(0.0093), Blame::rig);
  seen.sensor_lag_s = -0.01;
  EXPECT_EQ(blamed(0.02), Blame::reference);
}

TEST(SelfCheck, sees_a_bad_contact_that_comes_and_goes) {
  testing::FakeRig rig;
  rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (std::fmod(t_s, 1.0) < 0.02) b.adc[row] = static_cast<std::uint16_t>(b.adc[row] / 2);
  };
  EXPECT_EQ(unsound(rig), "rig_sensor_jumps");
}

TEST(SelfCheck, names_a_calibration_that_is_not_the_bench_s) {
  testing::FakeRig rig;
  rig.change_info().details = {{"reference_calibration", "FT1"}, {"reference_calibration_expected", "FT2"}};
  EXPECT_EQ(unsound(rig), "rig_reference_identity");
}

TEST(SelfCheck, does_not_pass_a_rig_that_gave_nothing) {
  RigInfo info;
  const auto checks = self_check(info, {});
  ASSERT_NE(first_unsound(checks), nullptr);
}

}  // namespace
}  // namespace forcegate
