#include "hil/characterize/capacitance/weight_gate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/decision.h"
#include "hil/interface/dut.h"

namespace forcegate::test {
namespace {

using namespace characterize;

WeightGatePlan small_plan() {
  WeightGatePlan p;
  p.study.step_N = 10.0;
  p.study.dc_samples = p.study.sine_samples = 800;
  p.loadings = 2;
  return p;
}

Result<std::unique_ptr<WeightBench>> bench(double rate_Hz) {
  return make_weight_bench("dead_weight", rate_Hz > 0.0 ? std::map<std::string, std::string>{{"rate_Hz", "40000"}} : std::map<std::string, std::string>{});
}

class WeightGate : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { pack_ = new PackFrames(play_pack(small_plan(), bench).value()); }
  static void TearDownTestSuite() { delete pack_; }

  // What a firmware without a fault answers.
  static std::vector<FrameAnswers> sound() {
    std::vector<FrameAnswers> out;
    for (const SensorFrames& s : pack_->sensors) {
      FrameAnswers a;
      for (const double f : s.oracle_N) {
        a.force_N.push_back(std::isnan(f) ? a.force_N.back() : f);
        a.flags.push_back(std::isnan(f) ? kDutInputRail : 0);
      }
      out.push_back(a);
    }
    return out;
  }

  static DecisionKind decision(const std::vector<FrameAnswers>& answers) {
    const WeightGatePlan plan = small_plan();
    std::vector<JudgedCheck> judged = judge_pack(plan, *pack_, answers);
    for (std::size_t s = 0; s < answers.size(); ++s)
      for (JudgedCheck& j : judge_sensor(plan, pack_->sensors[s], answers[s], "sensor" + std::to_string(s))) judged.push_back(std::move(j));
    std::vector<JudgedCheck*> all;
    for (JudgedCheck& j : judged) all.push_back(&j);
    apply_rule(plan.rule, all);
    std::vector<const Check*> checks;
    for (const JudgedCheck& j : judged) checks.push_back(&j.check);
    return decide(checks, plan.rule, {}).kind;
  }

  static PackFrames* pack_;
};
PackFrames* WeightGate::pack_ = nullptr;

TEST_F(WeightGate, frames_hold_both_channels_of_every_level_and_a_saturated_one) {
  ASSERT_EQ(pack_->sensors.size(), 8u);
  const SensorFrames& s = pack_->sensors[0];
  EXPECT_EQ(s.force_N.size(), 2u * 25u + 2u);
  EXPECT_EQ(s.codes.size(), s.force_N.size() * 800u);
  EXPECT_TRUE(std::isnan(s.oracle_N[50]));
  EXPECT_NEAR(s.oracle_N[51], 250.0, 5.0);
  EXPECT_NEAR(s.oracle_N[10], s.force_N[10], 5.0);
}

TEST_F(WeightGate, accepts_the_network_itself) { EXPECT_EQ(decision(sound()), DecisionKind::accept); }

TEST_F(WeightGate, rejects_a_force_that_is_off_in_a_single_frame) {
  auto answers = sound();
  answers[3].force_N[17] += 0.1;
  EXPECT_EQ(decision(answers), DecisionKind::reject);
}

TEST_F(WeightGate, rejects_a_force_that_is_no_number) {
  auto answers = sound();
  answers[5].force_N[4] = std::nan("");
  EXPECT_EQ(decision(answers), DecisionKind::reject);
}

TEST_F(WeightGate, rejects_a_saturated_frame_without_its_flag_and_a_sound_one_with_it) {
  auto answers = sound();
  answers[0].flags[50] = 0;
  EXPECT_EQ(decision(answers), DecisionKind::reject);
  answers = sound();
  answers[0].flags[10] = kDutInputRail;
  EXPECT_EQ(decision(answers), DecisionKind::reject);
}

TEST_F(WeightGate, rejects_the_conductance_model_for_want_of_error_reduction) {
  WeightGatePlan plan = small_plan();
  std::vector<FrameAnswers> answers = sound();
  for (std::size_t s = 0; s < answers.size(); ++s) answers[s].force_N = pack_->sensors[s].conductance_N;
  std::vector<JudgedCheck> judged = judge_pack(plan, *pack_, answers);
  EXPECT_NEAR(judged[1].check.value, 0.0, 1e-9);
  EXPECT_EQ(decision(answers), DecisionKind::reject);
}

TEST(WeightGatePlan, the_committed_one_is_good_and_its_loadings_are_none_of_the_training) {
  const auto plan = read_weight_gate_plan(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance-gate.toml");
  ASSERT_TRUE(plan.has_value()) << plan.error().to_text();
  EXPECT_GT(plan->first_loading, plan->study.most_training + plan->study.testing + 1);
  EXPECT_EQ(plan->frame_samples(), 800u);
  EXPECT_FALSE(read_weight_gate_plan(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance.toml").has_value());
}

}  // namespace
}  // namespace forcegate::test
