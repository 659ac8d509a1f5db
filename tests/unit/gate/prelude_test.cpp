// The session before RESET: what it shows of the firmware, and what it must not be blamed for.

#include "hil/gate/prelude.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "hil/gate/board_faults.h"
#include "hil/gate/judge.h"
#include "hil/gate/runner.h"
#include "tests/support/fake_dut.h"
#include "tests/support/fake_rig.h"

namespace forcegate {
namespace {

struct Played {
  CaseRecord record;
  JudgedCase judged;
  const Check* check(const std::string& id) const {
    for (const JudgedCheck& j : judged.checks)
      if (j.check.id == id) return &j.check;
    return nullptr;
  }
};

Played play(Dut& dut) {
  testing::FakeRig rig;
  CaseJob job;
  job.id = "sine/fake";
  job.nonce = 0x1234;
  job.planned.name = "sine";
  job.planned.controller = "open_loop";
  job.planned.prelude_s = 10.0;
  job.planned.stimulus.name = "sine";
  job.planned.stimulus.numbers = {
      {"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.0}, {"duration_s", 60.0}, {"ramp_s", 2.0}};
  job.calibration.gain_N_per_V = rig.gain_N_per_V;
  job.calibration.offset_N = rig.offset_N;
  RunDevices devices;
  devices.rig = &rig;
  devices.dut = &dut;
  Played played{run_case(job, devices), {}};
  const Plan plan;
  played.judged = judge_case(plan, job.planned, played.record, {});
  std::vector<JudgedCheck*> all;
  for (JudgedCheck& j : played.judged.checks) all.push_back(&j);
  apply_rule(plan.rule, all);
  return played;
}

void not_a_number_once(testing::FakeDut& dut) {
  dut.spoil = [spoiled = false](std::uint32_t, float& force_N, std::uint8_t&) mutable {
    if (!spoiled) force_N = std::numeric_limits<float>::quiet_NaN();
    spoiled = true;
  };
}

TEST(Prelude, hostile_codes_reach_both_rails_and_are_the_same_every_time) {
  const auto codes = hostile_codes(100000, 12, 1000.0);
  EXPECT_EQ(*std::min_element(codes.begin(), codes.end()), 0);
  EXPECT_EQ(*std::max_element(codes.begin(), codes.end()), 4095);
  EXPECT_EQ(codes, hostile_codes(100000, 12, 1000.0));
}

TEST(Prelude, what_the_firmware_does_before_its_reset_is_the_firmware_s_failure) {
  testing::FakeDut dut;
  not_a_number_once(dut);
  const Played played = play(dut);
  ASSERT_FALSE(played.record.failure) << played.record.failure->error.to_text();
  EXPECT_EQ(played.record.prelude.not_finite, 1u);
  EXPECT_EQ(played.record.output.not_finite, 0u);
  EXPECT_EQ(played.check("prelude_output")->verdict, Verdict::fail);
  EXPECT_EQ(played.check("prelude_output")->blame, Blame::firmware);
}

TEST(Prelude, over_a_link_that_lost_answers_it_says_nothing_about_the_firmware) {
  auto inner = std::make_unique<testing::FakeDut>();
  not_a_number_once(*inner);
  const auto dut = with_board_faults(std::move(inner), {{"link_loss", 0.01}}, 1);
  const Played played = play(*dut);
  ASSERT_FALSE(played.record.failure) << played.record.failure->error.to_text();
  EXPECT_EQ(played.check("link_intact")->verdict, Verdict::rig_error);
  EXPECT_EQ(played.check("prelude_output")->verdict, Verdict::rig_error);
  EXPECT_EQ(played.check("prelude_output")->blame, Blame::link);
}

TEST(Prelude, what_the_link_lost_before_the_reset_goes_on_being_counted) {
  const auto dut = with_board_faults(std::make_unique<testing::FakeDut>(), {{"link_loss", 1.0}}, 1);
  DutSession session;
  session.rate_Hz = 1000.0;
  PreludeFacts facts;
  ASSERT_TRUE(play_prelude(*dut, nullptr, session, 1.0, facts));
  const auto counters = dut->close();
  ASSERT_TRUE(counters);
  EXPECT_EQ(counters->indices_lost, 1000u);
}

}  // namespace
}  // namespace forcegate
