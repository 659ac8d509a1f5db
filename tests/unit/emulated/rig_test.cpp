// The emulated bench as a rig: determinism, geometry, motor, reference cell, converter, options.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "hil/base/digest.h"
#include "hil/base/parallel.h"
#include "tests/unit/emulated/maxima.h"

namespace forcegate::test {
namespace {

std::string digest(const RigBlock& b) {
  Sha256 sha;
  sha.update(std::span<const double>(b.t_s));
  sha.update(std::span<const float>(b.force_ref_N));
  sha.update(std::span<const std::uint16_t>(b.adc));
  sha.update(std::span<const float>(b.theta_rad));
  sha.update(std::span<const std::uint16_t>(b.status));
  return sha.hex();
}

std::unique_ptr<Stimulus> short_sine() {
  return stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.5}, {"m_N", 2.7}, {"duration_s", 30.0}});
}

std::string sine_digest(std::uint64_t seed, std::uint64_t session, std::uint64_t record) {
  BenchRun bench;
  bench.request.seed = seed;
  bench.request.session = session;
  bench.request.record = record;
  return digest(bench.play(*short_sine()));
}

TEST(EmulatedRig, gives_the_same_bits_for_the_same_seed_in_any_thread) {
  std::vector<std::string> digests(8);
  parallel_for(digests.size(), 4, [&](std::size_t i) { digests[i] = sine_digest(1 + i % 2, 3, 0); });
  for (std::size_t i = 0; i < digests.size(); ++i) EXPECT_EQ(digests[i], sine_digest(1 + i % 2, 3, 0));
  EXPECT_NE(digests[0], digests[1]);
}

TEST(EmulatedRig, tells_sessions_and_records_apart) {
  EXPECT_NE(sine_digest(1, 0, 0), sine_digest(1, 1, 0));
  EXPECT_NE(sine_digest(1, 0, 0), sine_digest(1, 0, 1));
}

TEST(EmulatedRig, does_not_depend_on_the_size_of_the_blocks_it_is_asked_for) {
  const auto play = [](std::size_t chunk) {
    const auto rig = value_or_abort(make_rig("emulated", {}));
    RigRecordRequest request;
    request.duration_s = 20.0;
    request.force_high_N = 4.0;
    EXPECT_TRUE(rig->begin(request).has_value());
    EXPECT_TRUE(rig->command_velocity(0.1).has_value());
    RigBlock block;
    block.resize(20000);
    std::size_t at = 0;
    while (at < 20000) {
      const std::size_t n = value_or_abort(rig->run(std::min<std::size_t>(chunk, 20000 - at), block, at));
      if (n == 0) break;
      at += n;
    }
    EXPECT_EQ(at, 20000U);
    EXPECT_EQ(value_or_abort(rig->run(10, block, 0)), 0U);  // the record has ended
    return digest(block);
  };
  const std::string whole = play(20000);
  EXPECT_EQ(play(1), whole);
  EXPECT_EQ(play(7), whole);
  EXPECT_EQ(play(1000), whole);
}

TEST(EmulatedRig, plays_a_profile_in_open_loop_up_to_4_Hz) {
  for (const double f_Hz : {0.5, 4.0}) {
    BenchRun bench;
    const auto block =
        bench.play(*stimulus("sine", {{"f_Hz", f_Hz}, {"A_N", 1.5}, {"m_N", 2.7}, {"duration_s", 20.0}}));
    float low = 100, high = 0;
    for (std::size_t i = 2000; i < block.size(); ++i) {
      low = std::min(low, block.force_ref_N[i]);
      high = std::max(high, block.force_ref_N[i]);
      EXPECT_EQ(block.status[i] & (kRigTravelStop | kRigMotorFault | kRigReferenceSaturated), 0);
    }
    EXPECT_NEAR(high, 4.2, 0.08) << f_Hz;
    EXPECT_NEAR(low, 1.2, 0.08) << f_Hz;
  }
}

TEST(EmulatedRig, reference_reads_in_steps_of_its_resolution_and_follows_the_spring) {
  BenchRun bench;
  const auto block = bench.play(*short_sine());
  const auto rig = value_or_abort(make_rig("emulated", {}));
  RigRecordRequest request;
  request.duration_s = 1.0;
  request.force_high_N = 4.2;
  ASSERT_TRUE(rig->begin(request).has_value());
  const RigGeometry g = rig->info().geometry;
  double worst_N = 0.0;
  for (std::size_t i = 0; i < block.size(); i += 17) {
    const double steps = static_cast<double>(block.force_ref_N[i]) / 0.025;
    EXPECT_NEAR(steps, std::round(steps), 1e-4);
    const double spring_N =
        g.spring_N_per_mm *
        (g.preload_mm + g.eccentricity_mm * (1.0 - std::cos(static_cast<double>(block.theta_rad[i]))));
    worst_N = std::max(worst_N, std::abs(static_cast<double>(block.force_ref_N[i]) - spring_N));
  }
  EXPECT_LT(worst_N, 0.06);
}

/// Time from the first motion to the instant after which `value` stays within 5 % of the step around its end.
template <class Value>
double settling_s(std::size_t step_at, Value value) {
  double start = 0, end = 0;
  for (std::size_t i = step_at - 500; i < step_at; ++i) start += value(i) / 500.0;
  for (std::size_t i = step_at + 900; i < step_at + 1400; ++i) end += value(i) / 500.0;
  std::size_t last = step_at;
  for (std::size_t i = step_at; i < step_at + 900; ++i) {
    double mean = 0.0;  // over 5 samples: the cell's noise is not a settling
    for (std::size_t k = i; k < i + 5; ++k) mean += value(k) / 5.0;
    if (std::abs(mean - end) > 0.05 * std::abs(end - start)) last = i;
  }
  return static_cast<double>(last + 1 - step_at) * 1e-3;
}

TEST(EmulatedRig, a_step_takes_about_70_ms_on_nano17_and_flexiforce_and_210_ms_on_the_fsr) {
  const auto step = stimulus("step", {{"low_N", 1.0}, {"high_N", 4.0}, {"at_s", 2.0}, {"duration_s", 5.0}});
  BenchRun flexiforce, fsr;
  fsr.rig_options = {{"sensor", "fsr"}};
  const RigBlock a = flexiforce.play(*step), b = fsr.play(*step);
  const double ati = settling_s(2000, [&](std::size_t i) { return static_cast<double>(a.force_ref_N[i]); });
  const double flexi = settling_s(2000, [&](std::size_t i) { return volts(a.adc[i]); });
  const double slow = settling_s(2000, [&](std::size_t i) { return volts(b.adc[i]); });
  std::printf(" step to within 5 %%: Nano17 %.0f ms, FlexiForce %.0f ms, FSR %.0f ms\n", 1e3 * ati,
              1e3 * flexi, 1e3 * slow);
  EXPECT_NEAR(ati, 0.070, 0.015);
  EXPECT_NEAR(flexi, 0.070, 0.015);
  EXPECT_NEAR(slow, 0.210, 0.030);
}

TEST(EmulatedRig, starts_at_rest_at_the_lowest_force_of_the_profile) {
  BenchRun bench;
  const auto block = bench.play(*short_sine());
  EXPECT_NEAR(block.force_ref_N[0], 1.2F, 0.05F);
}

TEST(EmulatedRig, keeps_the_force_inside_its_range_whatever_is_commanded) {
  const auto rig = value_or_abort(make_rig("emulated", {}));
  RigRecordRequest request;
  request.duration_s = 4.0;
  request.force_high_N = 5.4;
  ASSERT_TRUE(rig->begin(request).has_value());
  RigBlock block;
  block.resize(4000);
  ASSERT_TRUE(rig->command_velocity(1e9).has_value());
  ASSERT_EQ(value_or_abort(rig->run(2000, block, 0)), 2000U);
  ASSERT_TRUE(rig->command_velocity(-1e9).has_value());
  ASSERT_EQ(value_or_abort(rig->run(2000, block, 2000)), 2000U);
  EXPECT_TRUE(block.status[1999] & kRigTravelStop);
  EXPECT_NEAR(block.force_ref_N[1999], 5.5F, 0.06F);
  EXPECT_NEAR(block.force_ref_N[3999], 0.0F, 0.06F);
  // 40 rad/s at most: half a turn needs 79 ms
  EXPECT_FALSE(block.status[70] & kRigTravelStop);
}

TEST(EmulatedRig, converter_bits_and_rails_are_those_of_the_options) {
  BenchRun bench;
  bench.rig_options = {{"adc_bits", "12"}};
  const auto block = bench.play(*stimulus("ramp", {{"low_N", 0.0}, {"high_N", 5.4}, {"cycles", 1.0}}));
  bool low_rail = false;
  for (std::size_t i = 0; i < block.size(); ++i) {
    ASSERT_LE(block.adc[i], 4095);
    const bool rail = block.adc[i] == 0 || block.adc[i] == 4095;
    EXPECT_EQ(rail, (block.status[i] & kRigAdcRail) != 0);
    low_rail |= block.adc[i] == 0;
  }
  EXPECT_TRUE(low_rail);  // below F0 the circuit is at 0 V
}

TEST(EmulatedRig, refuses_what_it_does_not_know_and_says_how_to_mend_it) {
  for (const auto& [name, value] : std::map<std::string, std::string>{
           {"sensr", "fsr"}, {"sensor", "qtc"}, {"adc_bits", "24"}, {"rate_Hz", "150"}, {"noise", "maybe"}}) {
    const auto rig = make_rig("emulated", {{name, value}});
    ASSERT_FALSE(rig.has_value()) << name;
    EXPECT_EQ(rig.error().code, ErrorCode::config);
  }
  EXPECT_NE(make_rig("emulated", {{"sensr", "fsr"}}).error().hint.find("sensor"), std::string::npos);
  const auto rig = value_or_abort(make_rig("emulated", {}));
  RigRecordRequest request;
  request.duration_s = 1.0;
  request.force_high_N = 6.0;
  EXPECT_FALSE(rig->begin(request).has_value());
  request.force_high_N = 3.0;
  request.specimen = "q5x";
  EXPECT_FALSE(rig->begin(request).has_value());
  RigBlock block;
  block.resize(1);
  EXPECT_FALSE(rig->run(1, block, 0).has_value());
}

}  // namespace
}  // namespace forcegate::test
