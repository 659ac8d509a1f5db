#include "hil/gate/decision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

Check check(double value, double limit, double u = 0.0) {
  Check c;
  c.id = "mre_maxima";
  c.title = "Mean relative error of the maxima";
  c.value = value;
  c.unit = "%";
  c.u = u;
  c.limit = {Limit::Kind::upper, limit, "test"};
  return c;
}

std::vector<Check> judged(std::vector<Check> checks, const DecisionRule& rule = {}) {
  std::vector<JudgedCheck> list;
  for (const Check& c : checks) list.push_back({c, 0.0, true});
  std::vector<JudgedCheck*> pointers;
  for (JudgedCheck& j : list) pointers.push_back(&j);
  apply_rule(rule, pointers);
  std::vector<Check> out;
  for (const JudgedCheck& j : list) out.push_back(j.check);
  return out;
}

Decision decided(const std::vector<Check>& checks, const RunEvents& events = {},
                 const DecisionRule& rule = {}) {
  std::vector<const Check*> pointers;
  for (const Check& c : checks) pointers.push_back(&c);
  return decide(pointers, rule, events);
}

TEST(DecisionRule, has_the_four_zones_of_ISO_14253) {
  EXPECT_EQ(judged({check(4.0, 4.5, 0.1)})[0].verdict, Verdict::pass);
  EXPECT_EQ(judged({check(4.4, 4.5, 0.1)})[0].verdict, Verdict::marginal);
  EXPECT_EQ(judged({check(4.6, 4.5, 0.1)})[0].verdict, Verdict::inconclusive);
  EXPECT_EQ(judged({check(5.5, 4.5, 0.1)})[0].verdict, Verdict::fail);
}

TEST(DecisionRule, passes_an_exact_value_on_the_limit) {
  EXPECT_EQ(judged({check(4.5, 4.5)})[0].verdict, Verdict::pass);
  EXPECT_EQ(judged({check(std::nextafter(4.5, 5.0), 4.5)})[0].verdict, Verdict::fail);
}

TEST(DecisionRule, needs_more_evidence_to_reject_among_many_checks) {
  const Check doubtful = check(4.5 + 0.28, 4.5, 0.1);  // 2.8 u beyond: p = 0.0026
  EXPECT_EQ(judged({doubtful})[0].verdict, Verdict::fail);
  std::vector<Check> many(100, check(1.0, 4.5, 0.1));
  many[0] = doubtful;
  EXPECT_EQ(judged(many)[0].verdict, Verdict::inconclusive);
  many[0] = check(4.5 + 0.5, 4.5, 0.1);
  EXPECT_EQ(judged(many)[0].verdict, Verdict::fail);
}

TEST(DecisionRule, risk_at_the_acceptance_limit_is_that_of_JCGM_106) {
  // Truth on the limit, normal error: P(accepted) = P(value + 2 u <= limit) = 2.3 %.
  Rng rng(1);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i)
    accepted += zone(check(rng.normal(4.5, 0.1), 4.5, 0.1), 0.2) == Verdict::pass;
  EXPECT_NEAR(accepted / 20000.0, 0.0228, 0.003);
}

TEST(Looks, share_both_error_probabilities_between_them) {
  DecisionRule one, three;
  three.looks = 3;
  EXPECT_NEAR(three.coverage_per_look(), 1.0 - 0.0455 / 3.0, 1e-12);
  EXPECT_NEAR(three.alpha_per_look(), 0.01 / 3.0, 1e-12);
  const Check doubtful =
      check(4.5 - 0.22, 4.5, 0.1);  // 2.2 u inside: enough for one look, not for one of three
  EXPECT_EQ(judged({doubtful}, one)[0].verdict, Verdict::pass);
  EXPECT_EQ(judged({doubtful}, three)[0].verdict, Verdict::marginal);
  EXPECT_NEAR(judged({doubtful}, three)[0].expanded_u, 0.2427, 0.0005);
}

// Truth on the limit; one record more at each look until it is accepted or three were taken.
TEST(Looks, keep_the_stated_risk_of_accepting_a_build_on_its_limit) {
  DecisionRule rule;
  rule.looks = 3;
  Rng rng(7);
  int accepted = 0;
  constexpr int kRounds = 20000;
  for (int round = 0; round < kRounds; ++round) {
    double sum = 0.0;
    for (int n = 1; n <= rule.looks; ++n) {
      sum += rng.normal(4.5, 0.3);
      if (judged({check(sum / n, 4.5, 0.3 / std::sqrt(n))}, rule)[0].verdict != Verdict::pass) continue;
      ++accepted;
      break;
    }
  }
  EXPECT_LT(accepted / double{kRounds}, 0.0228 + 0.002);
  EXPECT_GT(accepted / double{kRounds}, 0.0228 / 3.0) << "the rule would be needlessly strict";
}

std::size_t worth(const std::vector<JudgedCheck>& list, const DecisionRule& rule) {
  std::vector<JudgedCheck> copy = list;
  std::vector<JudgedCheck*> pointers;
  for (JudgedCheck& j : copy) pointers.push_back(&j);
  apply_rule(rule, pointers);
  return worth_another_session(rule, pointers).size();
}

TEST(Looks, go_on_only_where_more_evidence_can_decide) {
  DecisionRule rule;
  rule.looks = 3;
  const auto item = [](double value, double u, double systematic, bool repeatable = true) {
    JudgedCheck j;
    j.check = check(value, 4.5, u);
    j.u_systematic = systematic;
    j.repeatable = repeatable;
    return j;
  };
  const JudgedCheck good = item(1.0, 0.1, 0.0), open = item(4.3, 0.3, 0.1), bad = item(9.0, 0.1, 0.0);
  EXPECT_EQ(worth({good, open}, rule), 1u);
  EXPECT_EQ(worth({good}, rule), 0u) << "nothing is open";
  EXPECT_EQ(worth({open, bad}, rule), 0u) << "it is rejected already";
  EXPECT_EQ(worth({open, item(4.4, 0.5, 0.499)}, rule), 0u) << "the systematic part dominates";
  EXPECT_EQ(worth({open, item(4.4, 0.3, 0.0, false)}, rule), 0u) << "this one cannot be repeated";
  JudgedCheck missing = open;
  missing.judgeable = false;
  missing.check.verdict = Verdict::not_run;
  EXPECT_EQ(worth({open, missing}, rule), 0u) << "no session gives what is missing";
  DecisionRule simple = rule;
  simple.name = "simple";
  EXPECT_EQ(worth({open}, simple), 0u) << "inside the limit is enough for this rule";
}

TEST(Decision, accepts_when_every_required_check_passed) {
  const Decision d = decided(judged({check(1.0, 4.5, 0.1), check(2.0, 7.5, 0.1)}));
  EXPECT_EQ(d.kind, DecisionKind::accept);
  EXPECT_EQ(d.exit_code, 0);
}

TEST(Decision, an_acceptance_names_every_comparison_that_was_left_out) {
  std::vector<Check> checks = judged({check(1.0, 4.5, 0.1)});
  for (const char* id : {"golden_firmware", "rig_golden", "conformance", "golden_firmware"}) {
    Check c;
    c.id = id;
    c.verdict = Verdict::not_run;
    c.required = false;
    c.evidence = std::string("why ") + id;
    checks.push_back(c);
  }
  EXPECT_EQ(decided(checks).reason,
            "all 1 required checks passed; conformance was not run: why conformance; comparison with the golden traces was not run: why rig_golden; "
            "firmware against its golden trace was not run: why golden_firmware");
}

TEST(Decision, rejects_and_names_the_check_first) {
  const Decision d = decided(judged({check(1.0, 4.5, 0.1), check(80.0, 4.5, 0.1)}));
  EXPECT_EQ(d.kind, DecisionKind::reject);
  EXPECT_EQ(d.exit_code, 1);
  EXPECT_EQ(d.blame, Blame::firmware);
  EXPECT_NE(d.reason.find("maxima"), std::string::npos);
}

TEST(Decision, names_the_finding_that_is_furthest_beyond_its_limit_and_one_that_ended_the_record_before_it) {
  const auto in_case = [](const char* id, const char* title, double value, double limit) {
    Check c = check(value, limit);
    c.id = id, c.title = title, c.case_id = "four_sines/q50";
    return c;
  };
  std::vector<Check> list{in_case("prelude_output", "Output under hostile codes", 1.0, 0.0), in_case("conformance", "Conformance", 1241.0, 0.5),
                          check(5.0, 4.5)};
  list.back().case_id = "four_sines/q50";
  EXPECT_EQ(decided(judged(list)).reason.substr(0, 11), "Conformance");
  list.push_back(in_case("firmware_runs", "Firmware runs", 1.0, 0.0));
  list.back().evidence = "the firmware crashed";
  EXPECT_NE(decided(judged(list)).reason.find("Firmware runs"), std::string::npos) << decided(judged(list)).reason;
}

TEST(Decision, does_not_accept_a_marginal_value_unless_the_rule_is_simple) {
  DecisionRule simple;
  simple.name = "simple";
  const auto marginal = judged({check(4.4, 4.5, 0.1)});
  EXPECT_EQ(decided(marginal).exit_code, 3);
  EXPECT_EQ(decided(marginal, {}, simple).exit_code, 0);
}

TEST(Decision, a_rig_error_is_retryable_and_never_blames_the_firmware) {
  auto checks = judged({check(1.0, 4.5)});
  checks.push_back(check(std::nan(""), 1.0));
  checks.back().verdict = Verdict::rig_error;
  checks.back().blame = Blame::reference;
  const Decision d = decided(checks);
  EXPECT_EQ(d.kind, DecisionKind::no_decision);
  EXPECT_EQ(d.exit_code, 4);
  EXPECT_EQ(d.blame, Blame::reference);
}

TEST(Decision, of_a_recording_nothing_is_retryable_and_nobody_mends_a_link) {
  std::vector<Check> checks = judged({check(1.0, 4.5), check(std::nan(""), 1.0)});
  checks.back().verdict = Verdict::rig_error;
  checks.back().blame = Blame::link;
  RunEvents events;
  events.of_recording = true;
  const Decision d = decided(checks, events);
  EXPECT_EQ(d.kind, DecisionKind::no_decision);
  EXPECT_EQ(d.exit_code, 3);
  EXPECT_EQ(d.blame, Blame::recording);
}

TEST(Decide, at_level_nominal_an_algorithm_that_only_the_image_knows_cannot_be_told_from_its_calibration) {
  Check unknown;
  unknown.id = "conformance";
  unknown.verdict = Verdict::not_run;
  unknown.required = false;
  RunEvents events;
  events.level = CalibrationLevel::nominal;
  std::vector<Check> checks = judged({check(8.0, 4.5, 0.1)});
  checks.push_back(unknown);
  const Decision d = decided(checks, events);
  EXPECT_EQ(d.kind, DecisionKind::no_decision);
  EXPECT_EQ(d.exit_code, 3);
  EXPECT_EQ(d.blame, Blame::calibration);
  events.level = CalibrationLevel::identified;
  EXPECT_EQ(decided(checks, events).kind, DecisionKind::reject);
}

TEST(Decision, names_the_calibration_level_when_a_conforming_image_fails_for_want_of_it) {
  auto checks = judged({check(11.7, 4.5, 0.3)});
  Check conformance = check(0.5, 1.0);
  conformance.id = "conformance";
  conformance.verdict = Verdict::pass;
  checks.push_back(conformance);
  RunEvents events;
  events.level = CalibrationLevel::nominal;
  const Decision d = decided(checks, events);
  EXPECT_EQ(d.kind, DecisionKind::reject);
  EXPECT_EQ(d.blame, Blame::calibration);
  EXPECT_NE(d.reason.find("calibration level 'nominal' is the cause"), std::string::npos);
}

TEST(Decision, a_calibration_that_was_given_is_never_the_firmwares_fault) {
  auto checks = judged({check(50.0, 4.5, 0.3)});
  RunEvents events;
  EXPECT_EQ(decided(checks, events).blame, Blame::firmware);
  Check fits = check(1.6, 1.0);
  fits.id = "rig_calibration_fits";
  fits.verdict = Verdict::inconclusive;
  fits.blame = Blame::calibration;
  std::vector<Check> misfit = checks;
  misfit.push_back(fits);
  const Decision one_misfits = decided(misfit, events);
  EXPECT_EQ(one_misfits.kind, DecisionKind::no_decision);
  EXPECT_EQ(one_misfits.exit_code, 3);
  EXPECT_EQ(one_misfits.blame, Blame::calibration);
  Check conformance = check(0.5, 1.0);
  conformance.id = "conformance";
  conformance.verdict = Verdict::pass;
  checks.push_back(conformance);
  EXPECT_EQ(decided(checks, events).kind, DecisionKind::reject);
  events.calibration_given = true;
  const Decision given = decided(checks, events);
  EXPECT_EQ(given.kind, DecisionKind::no_decision);
  EXPECT_EQ(given.blame, Blame::calibration);
  Check crash;
  crash.id = "firmware_runs";
  crash.verdict = Verdict::fail;
  crash.blame = Blame::firmware;
  misfit.push_back(crash);
  EXPECT_EQ(decided(misfit, events).kind, DecisionKind::reject) << "no calibration ends a firmware";
}

TEST(Decision, without_any_check_there_is_no_decision) {
  EXPECT_EQ(decided({}).exit_code, 3);
  Check waived = check(9.0, 1.0);
  waived.verdict = Verdict::waived;
  EXPECT_EQ(decided({waived}).exit_code, 3);
  RunEvents events;
  events.safety_stop = events.safety_cause_decided = true;
  EXPECT_TRUE(decided({waived}, events).safety_stop) << "told, whatever the reason";
}

TEST(Decision, does_not_believe_a_pass_that_is_none) {
  for (Check c :
       {check(std::nan(""), 4.5), check(9.0, 4.5), check(std::numeric_limits<double>::infinity(), 4.5)}) {
    c.verdict = Verdict::pass;
    EXPECT_NE(decided({c}).kind, DecisionKind::accept);
  }
}

TEST(Decision, a_reason_never_begins_with_the_opposite_of_the_decision) {
  Check runs;
  runs.id = "firmware_runs";
  runs.title = "The firmware answers every sample";
  runs.value = std::nan("");
  runs.verdict = Verdict::fail;
  runs.evidence = "the firmware crashed";
  EXPECT_EQ(decided({runs}).reason, "the firmware crashed");
  runs.id = "safety_stop";
  runs.title = "No safety stop";
  runs.evidence = "safety stop at 1.0 s: force above the limit (5.1 N); the firmware had left the ATI";
  RunEvents events;
  events.safety_stop = true;
  events.safety_text = "safety stop at 1.0 s: force above the limit (5.1 N)";
  EXPECT_EQ(decided({runs}, events).reason, runs.evidence) << "once";
  runs.id = "rig_runs";
  runs.title = "The rig plays the record";
  runs.verdict = Verdict::rig_error;
  runs.evidence = "the wheel does not reach";
  EXPECT_EQ(decided({runs}).reason, "the wheel does not reach");
}

TEST(Decision, undecided_safety_stop_has_its_own_exit_code) {
  RunEvents events;
  events.safety_stop = true;
  events.safety_cause_decided = false;
  EXPECT_EQ(decided(judged({check(1.0, 4.5)}), events).exit_code, 5);
  // also where a value beyond its limit could be the calibration's as well as the image's
  Check own = check(0.0, 1.0);
  own.id = "conformance";
  own.required = false;
  own.verdict = Verdict::not_run;
  events.level = CalibrationLevel::nominal;
  const std::vector<Check> cannot_be_told{judged({check(9.0, 4.5, 0.1)})[0], own};
  EXPECT_EQ(decided(cannot_be_told, events).exit_code, 5);
  EXPECT_TRUE(decided(cannot_be_told, events).safety_stop);
  events.safety_stop = false;
  EXPECT_EQ(decided(cannot_be_told, events).exit_code, 3);
}

// Whatever the checks hold: ACCEPT only when each required one carries a finite value inside its limit.
TEST(Decision, no_sequence_of_errors_missing_data_or_nan_yields_accept) {
  const double values[] = {0.0,
                           1.0,
                           4.5,
                           4.6,
                           -1.0,
                           1e308,
                           std::nan(""),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
  Rng rng(20111);
  int accepted = 0;
  for (int round = 0; round < 200000; ++round) {
    std::vector<Check> checks(rng.below(5));
    bool all_good = false, any = false;
    bool good = true;
    for (Check& c : checks) {
      c.value = values[rng.below(std::size(values))];
      c.u = rng.below(3) == 0 ? values[rng.below(std::size(values))] : 0.0;
      c.limit = {static_cast<Limit::Kind>(rng.below(4)), values[rng.below(std::size(values))], "x"};
      c.verdict = rng.below(2) == 0 ? Verdict::pass : static_cast<Verdict>(rng.below(7));
      c.blame = static_cast<Blame>(rng.below(9));
      c.required = rng.below(4) != 0;
      if (!c.required || c.verdict == Verdict::waived) continue;
      any = true;
      const bool inside = c.limit.kind == Limit::Kind::none ||
                          (c.limit.kind == Limit::Kind::upper && c.value <= c.limit.value) ||
                          (c.limit.kind == Limit::Kind::lower && c.value >= c.limit.value) ||
                          (c.limit.kind == Limit::Kind::equal && c.value == c.limit.value);
      good = good && c.verdict == Verdict::pass && std::isfinite(c.value) && inside;
    }
    all_good = any && good;
    RunEvents events;
    events.cancelled = rng.below(10) == 0;
    events.harness_error = rng.below(10) == 0;
    events.safety_stop = rng.below(10) == 0;
    events.safety_cause_decided = rng.below(2) == 0;
    const Decision d = decided(checks, events);
    EXPECT_FALSE(d.reason.empty());
    EXPECT_EQ(d.kind == DecisionKind::accept, d.exit_code == 0);
    EXPECT_EQ(d.kind == DecisionKind::reject, d.exit_code == 1);
    if (d.kind != DecisionKind::accept) continue;
    ++accepted;
    ASSERT_TRUE(all_good && !events.cancelled && !events.harness_error && !events.safety_stop)
        << "round " << round;
  }
  EXPECT_GT(accepted, 100) << "the test must also see what ACCEPT looks like";
}

TEST(DecisionRule, tells_an_inconclusive_value_with_its_limit) {
  Check close = check(5.2, 5.0, 0.3);
  close.evidence = "590 maxima, largest 9.1 %";
  const Decision d = decided(judged({close}));
  EXPECT_EQ(d.exit_code, 3);
  EXPECT_EQ(d.reason, "not decided: Mean relative error of the maxima " + with_uncertainty(5.2, 0.3) + " % > 5 % (test): 590 maxima, largest 9.1 %");
}

}  // namespace
}  // namespace forcegate
