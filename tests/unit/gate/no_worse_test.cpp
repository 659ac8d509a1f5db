#include "hil/gate/no_worse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/run_judge.h"

namespace forcegate {
namespace {

PlanCase sine() {
  PlanCase c;
  c.name = "sine";
  c.checks = kCheckAccuracy;
  return c;
}

// 100 periods of 2 s; the firmware is off by `error` at every extremum and by `swing` alternately.
CaseRecord record(const std::string& specimen, double error, double swing = 0.0) {
  CaseRecord r;
  r.id = "sine/" + specimen;
  r.facts.mean_N = 2.0;
  r.facts.amplitude_N = 1.0;
  r.facts.dynamic = true;
  r.rig.can_move = true;
  for (int i = 0; i < 100; ++i)
    for (const bool maximum : {true, false}) {
      CasePair p;
      p.maximum = maximum;
      p.t_s = 2.0 * i + (maximum ? 0.0 : 1.0);
      p.ati_N = maximum ? 3.0 : 1.0;
      p.dut_N = p.ati_N * (1.0 + error + (i % 2 == 0 ? swing : -swing));
      r.pairs.push_back(p);
    }
  return r;
}

std::vector<JudgedCheck> ruled(std::vector<JudgedCheck> checks) {
  EXPECT_FALSE(checks.empty()) << "what looks at each of none proves nothing";
  std::vector<JudgedCheck*> all;
  for (JudgedCheck& j : checks) all.push_back(&j);
  apply_rule({}, all);
  return checks;
}

std::vector<JudgedCheck> compare(const std::vector<CaseRecord>& candidate,
                                 const std::vector<CaseRecord>& accepted, bool repeats = true) {
  const Plan plan;
  std::vector<ErrorIncrease> all;
  for (std::size_t i = 0; i < candidate.size(); ++i)
    for (ErrorIncrease& e : error_increases(plan, sine(), candidate[i], accepted[i]))
      all.push_back(std::move(e));
  return ruled(judge_no_worse(plan, all, repeats));
}

TEST(NoWorse, the_same_build_has_no_increase_at_all) {
  const auto checks = compare({record("q25", 0.05, 0.02)}, {record("q25", 0.05, 0.02)});
  ASSERT_EQ(checks.size(), 2U);
  EXPECT_EQ(checks[0].check.id, "no_worse_maxima/sine");
  EXPECT_EQ(checks[0].check.value, 0.0);
  EXPECT_EQ(checks[0].check.verdict, Verdict::pass);
}

TEST(NoWorse, the_mean_increase_over_the_specimens_is_limited_to_half_a_point) {
  const auto inside =
      compare({record("q25", 0.054), record("q75", 0.034)}, {record("q25", 0.050), record("q75", 0.030)});
  EXPECT_NEAR(inside[0].check.value, 0.4, 1e-9);
  EXPECT_EQ(inside[0].check.verdict, Verdict::pass);
  const auto beyond =
      compare({record("q25", 0.057), record("q75", 0.034)}, {record("q25", 0.050), record("q75", 0.030)});
  EXPECT_NEAR(beyond[0].check.value, 0.55, 1e-9);
  EXPECT_EQ(beyond[0].check.verdict, Verdict::fail);
  EXPECT_TRUE(beyond[0].check.required);
}

TEST(NoWorse, a_better_build_passes_however_different_it_is) {
  const auto checks = compare({record("q25", 0.01)}, {record("q25", 0.09)});
  EXPECT_NEAR(checks[0].check.value, -8.0, 1e-9);
  EXPECT_EQ(checks[0].check.verdict, Verdict::pass);
}

TEST(NoWorse, the_uncertainty_comes_from_the_pairs_and_shrinks_with_them) {
  const auto checks = compare({record("q25", 0.054, 0.02)}, {record("q25", 0.050)});
  EXPECT_NEAR(checks[0].check.u, 2.0 / std::sqrt(99.0), 1e-3);  // 2 points, 100 pairs
  EXPECT_EQ(checks[0].check.verdict, Verdict::marginal) << "0.4 points, but by less than its uncertainty";
  const auto many = compare(std::vector(4, record("q25", 0.054, 0.02)), std::vector(4, record("q25", 0.050)));
  EXPECT_NEAR(many[0].check.u, checks[0].check.u / 2.0, 1e-9);
}

TEST(NoWorse, a_rig_that_does_not_repeat_itself_adds_what_two_records_differ_by) {
  const auto checks = compare({record("q25", 0.05)}, {record("q25", 0.05)}, false);
  EXPECT_NEAR(checks[0].check.u, PlanUncertainty{}.record_repeat_pct * std::sqrt(2.0), 1e-9);
  EXPECT_NE(checks[0].check.verdict, Verdict::pass);
}

TEST(NoWorse, a_record_without_its_partner_is_no_pass) {
  CaseRecord shorter = record("q25", 0.05);
  shorter.pairs.resize(100);
  CaseRecord failed = record("q25", 0.05);
  failed.failure = CaseFailure{};
  CaseRecord nan = record("q25", 0.05);
  nan.pairs[10].dut_N = std::nan("");
  for (const CaseRecord& bad : {shorter, failed, nan})
    for (const JudgedCheck& j : compare({bad}, {record("q25", 0.05)})) {
      if (j.check.id == "no_worse_minima/sine" && !bad.failure && bad.pairs.size() == 200) continue;
      EXPECT_EQ(j.check.verdict, Verdict::inconclusive) << j.check.id;
    }
}

Check check_of(const char* id, Verdict verdict, Blame blame, const char* evidence) {
  Check c;
  c.id = id;
  c.verdict = verdict;
  c.blame = blame;
  c.evidence = evidence;
  return c;
}

// A candidate that is ten points worse, beside an accepted record with which something is the matter.
std::vector<JudgedCheck> compare_beside(const NoPartner& partner) {
  return ruled(judge_no_worse(Plan{}, error_increases(Plan{}, sine(), record("q25", 0.15), record("q25", 0.05), partner), true));
}

TEST(NoWorse, a_rig_fault_beside_the_accepted_build_is_the_rigs_and_of_a_stored_run_whoever_gave_it) {
  const Check slipped = check_of("rig_spring", Verdict::rig_error, Blame::reference, "the spring slipped");
  for (const JudgedCheck& j : compare_beside(no_partner("sine/q25", {&slipped, 1}, false))) {
    EXPECT_EQ(j.check.verdict, Verdict::rig_error) << j.check.id;
    EXPECT_EQ(j.check.blame, Blame::reference);
    EXPECT_NE(j.check.evidence.find("the spring slipped"), std::string::npos) << j.check.evidence;
  }
  for (const JudgedCheck& j : compare_beside(no_partner("sine/q25", {&slipped, 1}, true))) {
    EXPECT_EQ(j.check.verdict, Verdict::not_run) << j.check.id;
    EXPECT_EQ(j.check.blame, Blame::user);
    EXPECT_NE(j.check.evidence.find("give a run on a sound rig"), std::string::npos) << j.check.evidence;
  }
  const Check cut = check_of("coverage", Verdict::inconclusive, Blame::link, "the record is truncated");
  for (const JudgedCheck& j : compare_beside(no_partner("sine/q25", {&cut, 1}, false))) EXPECT_EQ(j.check.verdict, Verdict::inconclusive);
  for (const JudgedCheck& j : compare_beside(no_partner("sine/q25", {}, false))) EXPECT_EQ(j.check.verdict, Verdict::fail) << "on a sound rig it counts";
}

TEST(NoWorse, values_of_a_stored_run_that_its_rig_spoiled_are_nobodys_but_whose_run_it_is) {
  CaseResult stored;
  stored.checks = {check_of("rig_spring", Verdict::rig_error, Blame::rig, "the spring slipped")};
  JudgedCheck own;
  own.check.id = "mre_maxima";
  own.check.limit.kind = Limit::Kind::upper;
  const auto checks = ruled(judge_no_worse(Plan{}, error_increases(sine(), "sine/q25", {&own, 1}, stored, true), true));
  ASSERT_FALSE(checks.empty());
  EXPECT_EQ(checks[0].check.verdict, Verdict::not_run);
  EXPECT_EQ(checks[0].check.blame, Blame::user);
}

TEST(NoWorse, a_candidate_whose_rig_was_at_fault_is_not_compared) {
  Plan plan;
  plan.cases = {sine()};
  PlayedRecord one;
  one.record = record("q25", 0.15);
  JudgedCheck fault;
  fault.check = check_of("rig_spring", Verdict::rig_error, Blame::reference, "the spring slipped");
  one.judged.checks = {fault};
  const auto increases = error_increases(plan, sine(), one.record, record("q25", 0.05));
  auto checks = judge_no_worse(plan, increases, true);
  charge_compared(plan, {one}, checks);
  for (const JudgedCheck& j : ruled(checks)) {
    EXPECT_EQ(j.check.verdict, Verdict::rig_error);
    EXPECT_EQ(j.check.blame, Blame::reference);
  }
  checks = judge_no_worse(plan, increases, true);
  one.superseded = true;
  charge_compared(plan, {one}, checks);
  for (const JudgedCheck& j : ruled(checks)) EXPECT_EQ(j.check.verdict, Verdict::fail) << "a later attempt stands for it";
}

TEST(NoWorse, an_accepted_build_that_does_not_run_is_named_and_not_the_candidate) {
  const Check dead = check_of("firmware_runs", Verdict::fail, Blame::firmware, "crashed with signal SEGV");
  for (const JudgedCheck& j : compare_beside(no_partner("sine/q25", {&dead, 1}, false))) {
    EXPECT_EQ(j.check.verdict, Verdict::not_run);
    EXPECT_EQ(j.check.blame, Blame::user);
    EXPECT_NE(j.check.evidence.find("the accepted build"), std::string::npos) << j.check.evidence;
    EXPECT_NE(j.check.evidence.find("SEGV"), std::string::npos) << j.check.evidence;
  }
}

// The force channel of a recording begins with the loading, from 0 N.
TEST(NoWorse, the_minima_of_a_recording_are_those_that_are_judged_and_not_its_lowest_force) {
  CaseRecord recording = record("1", 0.05);
  recording.rig.can_move = false;
  recording.facts.mean_N = recording.facts.amplitude_N = 1.5;
  const auto checks = compare({recording}, {recording});
  ASSERT_EQ(checks.size(), 2U);
  EXPECT_EQ(checks[1].check.id, "no_worse_minima/sine");
  EXPECT_EQ(checks[1].check.verdict, Verdict::pass);
  for (CasePair& p : recording.pairs)
    if (!p.maximum) p.ati_N = p.dut_N = 0.3;
  EXPECT_EQ(compare({recording}, {recording}).size(), 1U) << "minima below 0.5 N are judged by their absolute error";
}

Check mre(const char* id, double value, double u) {
  Check c;
  c.id = id;
  c.value = value;
  c.u = u;
  c.limit = {Limit::Kind::upper, 10.0, "test"};
  return c;
}

TEST(NoWorse, a_stored_run_is_compared_by_its_values) {
  CaseResult stored;
  stored.checks = {mre("mre_maxima", 5.0, 0.03), mre("mre_minima", 2.0, 0.03)};
  const std::vector<JudgedCheck> candidate{{mre("mre_maxima", 5.6, 0.04)}, {mre("mre_minima", 2.0, 0.04)}};
  const auto increases = error_increases(sine(), "q50", candidate, stored, false);
  ASSERT_EQ(increases.size(), 2U);
  EXPECT_NEAR(increases[0].increase_pct, 0.6, 1e-9);
  EXPECT_NEAR(increases[0].u_pct, 0.05, 1e-9);
  const auto checks = ruled(judge_no_worse(Plan{}, increases, true));
  EXPECT_EQ(checks[0].check.verdict, Verdict::inconclusive);
  EXPECT_EQ(checks[1].check.verdict, Verdict::pass);
}

TEST(NoWorse, what_a_rig_repeats_is_not_added_twice_to_a_difference_of_stored_values) {
  CaseResult stored;
  stored.checks = {mre("mre_maxima", 5.0, 0.8), mre("mre_minima", 2.0, 0.8)};
  std::vector<JudgedCheck> candidate{{mre("mre_maxima", 5.0, 0.8)}, {mre("mre_minima", 2.0, 0.8)}};
  for (JudgedCheck& j : candidate) j.u_systematic = std::sqrt(0.64 - 0.0004);
  const auto shared = error_increases(sine(), "q50", candidate, stored, true);
  EXPECT_NEAR(shared[0].u_pct, 0.02 * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(ruled(judge_no_worse(Plan{}, shared, true))[0].check.verdict, Verdict::pass) << "the identical build";
  EXPECT_NEAR(error_increases(sine(), "q50", candidate, stored, false)[0].u_pct, 0.8 * std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace forcegate
