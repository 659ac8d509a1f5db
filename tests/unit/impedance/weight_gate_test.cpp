#include "hil/characterize/capacitance/weight_material.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/decision.h"
#include "hil/gate/statistics.h"
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
  return make_weight_bench("dead_weight", rate_Hz > 0.0
                                              ? std::map<std::string, std::string>{{"rate_Hz", "40000"}}
                                              : std::map<std::string, std::string>{});
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

  static std::vector<JudgedCheck> of_pack(const WeightGatePlan& plan,
                                          const std::vector<FrameAnswers>& answers) {
    std::vector<const SensorFrames*> frames;
    std::vector<const FrameAnswers*> pointers;
    for (std::size_t s = 0; s < answers.size(); ++s)
      frames.push_back(&pack_->sensors[s]), pointers.push_back(&answers[s]);
    return judge_pack(plan, frames, pointers);
  }

  static DecisionKind decision(const std::vector<FrameAnswers>& answers) {
    const WeightGatePlan plan = small_plan();
    std::vector<JudgedCheck> judged = of_pack(plan, answers);
    for (std::size_t s = 0; s < answers.size(); ++s)
      for (JudgedCheck& j : judge_sensor(plan, pack_->sensors[s], answers[s], "sensor" + std::to_string(s)))
        judged.push_back(std::move(j));
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
  std::vector<JudgedCheck> judged = of_pack(plan, answers);
  EXPECT_NEAR(judged[1].check.value, 0.0, 1e-9);
  EXPECT_EQ(decision(answers), DecisionKind::reject);
}

// A whole run with these answers.
WeightMaterial run_of(const PackFrames& pack, const std::vector<FrameAnswers>& answers) {
  WeightMaterial m;
  m.plan = small_plan();
  m.sensors = pack.sensors.size();
  for (std::size_t s = 0; s < answers.size(); ++s) {
    SensorRecord& r = m.records.emplace_back();
    r.sensor = s, r.frames = pack.sensors[s], r.answers = answers[s];
    m.head.cases.emplace_back().id = "sensor" + std::to_string(s + 1);
  }
  return m;
}

RunResult judged(WeightMaterial m) {
  const auto of_run = judge_material(m);
  return to_run_result(m, of_run);
}

const Check& of(const std::vector<Check>& checks, std::string_view id) {
  for (const Check& c : checks)
    if (c.id == id) return c;
  static const Check kNone;
  return kNone;
}

TEST_F(WeightGate, a_bench_on_which_the_network_itself_errs_is_never_blamed_on_the_firmware) {
  WeightMaterial m = run_of(*pack_, sound());
  for (std::size_t i = 0; i < m.records[2].frames.force_N.size(); ++i)
    m.records[2].frames.oracle_N[i] += 4.0, m.records[2].answers.force_N[i] += 4.0;
  const RunResult result = judged(m);
  EXPECT_EQ(result.decision.kind, DecisionKind::no_decision) << result.decision.reason;
  EXPECT_EQ(result.decision.blame, Blame::rig);
  EXPECT_EQ(of(result.cases[2].checks, "mse").verdict, Verdict::rig_error);
  EXPECT_EQ(of(result.cases[2].checks, "conformance").verdict, Verdict::pass)
      << "arithmetic on the same codes stays judged";
  EXPECT_EQ(of(result.cases[3].checks, "mse").verdict, Verdict::pass);
  EXPECT_EQ(of(result.checks, "mse_pack").verdict, Verdict::rig_error);
}

TEST_F(WeightGate, a_firmware_that_departs_from_the_network_is_blamed_on_a_spoiled_bench_too) {
  WeightMaterial m = run_of(*pack_, sound());
  for (std::size_t i = 0; i < m.records[2].frames.force_N.size(); ++i) m.records[2].frames.oracle_N[i] += 4.0;
  EXPECT_EQ(judged(m).decision.kind, DecisionKind::reject);
}

TEST_F(WeightGate, a_session_that_broke_off_leaves_the_pack_unjudged_and_rejects) {
  WeightMaterial m = run_of(*pack_, sound());
  m.records[1].failure =
      Error{ErrorCode::firmware, "the firmware crashed with signal SEGV after sample 800", "sensor2", {}};
  const RunResult result = judged(m);
  EXPECT_EQ(result.decision.kind, DecisionKind::reject);
  EXPECT_TRUE(result.checks.empty());
  EXPECT_NE(result.cases[1].note.find("SEGV"), std::string::npos);
  m.records[1].failure->code = ErrorCode::cancelled;
  EXPECT_EQ(judged(m).decision.exit_code, 130);
}

TEST_F(WeightGate, a_session_that_the_image_did_not_break_is_the_links) {
  WeightMaterial m = run_of(*pack_, sound());
  m.records[1].failure = Error{ErrorCode::timeout, "the emulator got no time", "sensor2", {}};
  const RunResult result = judged(m);
  EXPECT_EQ(result.decision.exit_code, 4) << result.decision.reason;
  EXPECT_EQ(result.decision.blame, Blame::link);
  EXPECT_NE(result.decision.reason.find("got no time"), std::string::npos) << result.decision.reason;
  m.records[1].failure->code = ErrorCode::firmware;
  EXPECT_NE(judged(m).decision.reason.find("got no time"), std::string::npos) << "the headline says what happened";
  m.records[1].failure->code = ErrorCode::internal;
  EXPECT_EQ(judged(m).decision.exit_code, 6);
}

TEST_F(WeightGate, an_accepted_build_without_an_answer_is_not_the_candidates) {
  WeightMaterial m = run_of(*pack_, sound());
  m.with_accepted = true;
  const RunResult result = judged(m);
  EXPECT_EQ(of(result.checks, "no_worse_per").verdict, Verdict::not_run);
  EXPECT_EQ(result.decision.blame, Blame::user) << result.decision.reason;
  EXPECT_EQ(result.decision.exit_code, 3);
}

TEST_F(WeightGate, the_same_build_is_no_worse_than_itself_and_a_worse_one_is) {
  WeightMaterial m = run_of(*pack_, sound());
  m.with_accepted = true;
  for (SensorRecord& r : m.records) r.accepted_N = r.answers.force_N;
  RunResult same = judged(m);
  EXPECT_EQ(same.decision.kind, DecisionKind::accept) << same.decision.reason;
  EXPECT_EQ(of(same.checks, "no_worse_per").value, 0.0);
  // The accepted build stood on the weights themselves: all of the network's error is a loss.
  for (SensorRecord& r : m.records) r.accepted_N = r.frames.force_N;
  const RunResult worse = judged(m);
  EXPECT_EQ(worse.decision.kind, DecisionKind::reject);
  EXPECT_NEAR(of(worse.checks, "no_worse_per").value, 100.0 - of(worse.checks, "per_pack").value, 1e-9);
  const double k = coverage_factor(0.95, 0.0);
  const auto rest = compare_with_accepted(m);
  EXPECT_GT(rest.dof, 1.0);
  EXPECT_LE(rest.dof, static_cast<double>(m.sensors * (m.plan.loadings - 1)));
  EXPECT_GT(coverage_factor(0.95, rest.dof), k) << "a few loadings are no normal law";
  m.records[5].accepted_N.clear();
  const RunResult partner = judged(m);
  EXPECT_EQ(of(partner.checks, "no_worse_per").verdict, Verdict::not_run);
  EXPECT_NE(of(partner.checks, "no_worse_per").evidence.find("sensor6"), std::string::npos);
}

TEST_F(WeightGate, a_part_of_the_pack_is_judged_without_the_checks_of_the_pack) {
  WeightMaterial m = run_of(*pack_, sound());
  m.records.resize(3), m.head.cases.resize(3);
  const RunResult result = judged(m);
  EXPECT_EQ(result.decision.kind, DecisionKind::accept);
  EXPECT_TRUE(result.checks.empty());
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
