// What a firmware does for a few swings out of hundreds: a mean hardly moves, and in a closed loop the wheel does what it asked for.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::find;

// A record on a bench with a wheel, whose spring is a witness of the ATI.
CaseRecord sound(Bench& bench) {
  CaseRecord record = bench.run();
  record.observed.spring_samples = 1000;
  record.observed.spring_slope = 1.0;
  record.conformance_known = false;
  return record;
}

void falls_out(CaseRecord& record, double by_N, std::size_t extrema, bool codes_too = false) {
  const std::size_t from = record.pairs.size() / 2;
  for (std::size_t i = from; i < from + extrema; ++i) {
    record.pairs[i].dut_N -= by_N;
    if (codes_too) record.pairs[i].raw_N -= by_N;
  }
}

TEST(OutputExcursion, a_correction_that_falls_out_for_a_few_swings_fails) {
  Bench bench;
  CaseRecord record = sound(bench);
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->verdict, Verdict::pass);
  EXPECT_LT(find(bench.judge(record), "output_excursion")->value, 0.1);
  falls_out(record, 3.0, 4);
  const JudgedCase judged = bench.judge(record);
  const Check& c = *find(judged, "output_excursion");
  EXPECT_EQ(c.verdict, Verdict::fail) << c.evidence;
  EXPECT_EQ(c.blame, Blame::firmware);
  EXPECT_NEAR(c.value, 3.0, 0.1);
  EXPECT_GT(c.u, 0.0);
  EXPECT_TRUE(c.required);
  bench.plan.limits.excursion_max_N = 4.0;
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->verdict, Verdict::pass);
}

TEST(OutputExcursion, an_error_that_grows_is_none) {
  Bench bench;
  CaseRecord record = sound(bench);
  for (CasePair& p : record.pairs) p.dut_N += 0.05 * p.t_s;
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->verdict, Verdict::pass) << find(bench.judge(record), "output_excursion")->value;
}

TEST(OutputExcursion, what_the_codes_have_too_or_nothing_witnesses_is_not_decided) {
  Bench bench;
  CaseRecord record = sound(bench);
  falls_out(record, 3.0, 4, true);
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->verdict, Verdict::inconclusive);
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->blame, Blame::sensor);
  record = sound(bench);
  falls_out(record, 3.0, 4);
  record.observed.spring_samples = 0;
  EXPECT_EQ(find(bench.judge(record), "output_excursion")->verdict, Verdict::inconclusive);
}

TEST(OutputExcursion, an_algorithm_that_is_implemented_twice_is_judged_by_conformance) {
  Bench bench;
  CaseRecord record = sound(bench);
  falls_out(record, 3.0, 4);
  record.conformance_known = true;
  EXPECT_EQ(find(bench.judge(record), "output_excursion"), nullptr);
}

// From the middle on the wheel stands at the end of its force, because the firmware reads a low one.
CaseRecord led_astray(Bench& bench, double dut_N) {
  bench.close_loop();
  CaseRecord record = sound(bench);
  for (std::size_t i = record.pairs.size() / 2; i < record.pairs.size(); ++i) record.pairs[i].ati_N = 5.0, record.pairs[i].dut_N = dut_N;
  return record;
}

TEST(LedAstray, what_the_firmware_made_the_wheel_do_is_not_charged_to_the_rig) {
  Bench bench;
  const JudgedCase judged = bench.judge(led_astray(bench, 2.0));
  const Check& c = *find(judged, "extrema_count");
  EXPECT_EQ(c.verdict, Verdict::fail) << c.evidence;
  EXPECT_EQ(c.blame, Blame::firmware);
  EXPECT_NE(c.evidence.find("the firmware had left the ATI"), std::string::npos) << c.evidence;
}

TEST(LedAstray, a_command_that_is_no_number_is_told_by_the_answer_that_made_it) {
  Bench bench;
  CaseRecord record = led_astray(bench, 2.0);
  record.safety.reason = StopReason::bad_command;
  record.safety.t_s = 30.0;
  record.output.not_finite = 9;
  for (const double first_s : {29.999, 31.0}) {
    record.output.first_not_finite_s = first_s;
    const JudgedCase judged = bench.judge(record);
    const Check& c = *find(judged, "safety_stop");
    EXPECT_EQ(c.blame, Blame::firmware);
    EXPECT_EQ(c.evidence.starts_with("the firmware answers no number (NaN or infinite) from 30.0 s on; safety stop at 30.0 s"), first_s < 30.0) << c.evidence;
  }
}

TEST(LedAstray, a_firmware_that_reports_what_the_reference_does_is_not_charged) {
  Bench bench;
  const JudgedCase judged = bench.judge(led_astray(bench, 5.0));
  EXPECT_EQ(find(judged, "extrema_count")->verdict, Verdict::inconclusive);
  EXPECT_EQ(find(judged, "extrema_count")->blame, Blame::rig);
}

TEST(LedAstray, nor_is_one_that_conforms_or_whose_link_lost_samples) {
  Bench bench;
  CaseRecord conforms = led_astray(bench, 2.0), lossy = conforms;
  conforms.conformance_known = true;
  conforms.conformance_limit = 1.0;
  EXPECT_EQ(find(bench.judge(conforms), "extrema_count")->verdict, Verdict::inconclusive);
  lossy.link.frames_dropped = 1;
  EXPECT_EQ(find(bench.judge(lossy), "extrema_count")->verdict, Verdict::inconclusive);
}

}  // namespace
}  // namespace forcegate
