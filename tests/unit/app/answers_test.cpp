// What answers say to people on the console.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/diagnose/next.h"
#include "hil/app/model/fit.h"
#include "hil/app/stored/run_diff.h"

namespace forcegate {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(DiagnosisText, SaysWhenChanceAlonePassesTheThreshold) {
  Diagnosis d;
  EXPECT_THAT(diagnosis_text(d), Not(HasSubstr("by chance")));
  d.expected_false = 0.83;
  EXPECT_THAT(diagnosis_text(d), HasSubstr("turned over by chance, 0.83 effects pass the threshold"));
}

TEST(DiagnosisText, CountsOneEffectAsOne) {
  Diagnosis d;
  d.expected_false = 1.0;
  EXPECT_THAT(diagnosis_text(d), HasSubstr("1 effect passes the threshold"));
}

TEST(DiagnosisText, SaysOnceWhatPartsSeveralLookAlikes) {
  Diagnosis d;
  d.verdict = DiagnosisVerdict::known;
  Finding f;
  f.effect = "lag", f.probability = 0.9;
  f.confounded_with = {{"delay", 0.99, "fast edges"}, {"mounting", 0.9, "an unloading"}, {"rc", 0.98, "fast edges"}, {"clock_skew", 0.0, "a long record"}};
  d.findings = {f};
  const std::string text = diagnosis_text(d);
  EXPECT_THAT(text, HasSubstr("looks like delay on these records (cos 0.99), rc (cos 0.98); fast edges\n"));
  EXPECT_THAT(text, HasSubstr("looks like mounting on these records (cos 0.90); an unloading\n"));
  EXPECT_THAT(text, HasSubstr("clock_skew fits nearly as well; a long record\n"));
  EXPECT_EQ(text.find("fast edges"), text.rfind("fast edges"));
}

TEST(DiagnosisText, SaysWhatTheErrorHoldsThatIsNotClaimed) {
  Diagnosis d;
  d.verdict = DiagnosisVerdict::known;
  d.error_before = 0.0233, d.error_after = 0.0102, d.floor = 0.004;
  d.steps = {{"", 0.0233}, {"static_nonlinearity", 0.0169}, {"off_axis", 0.0102}};
  Finding curve, push;
  curve.effect = "static_nonlinearity", curve.probability = 0.98;
  push.effect = "off_axis", push.probability = 0.49;
  d.findings = {curve, push};
  EXPECT_THAT(diagnosis_text(d), HasSubstr("23.3 -> 10.2 mV, with off_axis, which is not claimed (floor 4 mV)"));
  d.findings[1].probability = 0.9;
  EXPECT_THAT(diagnosis_text(d), HasSubstr("23.3 -> 10.2 mV (floor 4 mV)"));
}

TEST(DiagnosisText, SaysWhatStandsBesideANone) {
  Diagnosis d;
  d.floor = d.error_before = d.error_after = 0.002;
  EXPECT_THAT(diagnosis_text(d), HasSubstr("could show\n"));
  Finding f;
  f.effect = "humidity", f.probability = 0.25, f.effect_rms = 0.1;
  f.not_claimed("nobody recorded it");
  d.findings = {f};
  d.far_above = {{"r05", 3.7}};
  EXPECT_THAT(diagnosis_text(d), HasSubstr("could show; but humidity is suspected and not claimed, and far above its noise stands r05 (3.7 times)\n"));
  EXPECT_THAT(diagnosis_text(d), HasSubstr("; not claimed: nobody recorded it"));
  EXPECT_THAT(to_json(d), HasSubstr("\"why\": \"nobody recorded it\""));
  EXPECT_THAT(to_json(d), HasSubstr("\"far_above\""));
  EXPECT_THAT(next_text(d), testing::AllOf(HasSubstr("humidity is suspected"), HasSubstr("one ramp repeated"), HasSubstr("no plan that comes with the program plays that")));
}

TEST(NextText, SaysPlainlyWhereNoPlanHoldsWhatIsAskedFor) {
  Diagnosis d;
  d.verdict = DiagnosisVerdict::unknown;
  d.not_separable = {{"delay", "lag", "rc"}};
  EXPECT_THAT(next_text(d), testing::AllOf(HasSubstr("1 kHz"), HasSubstr("no plan that comes with the program plays that")));
  d.not_separable = {{"creep", "thermal"}};
  EXPECT_THAT(next_text(d), HasSubstr("the plan campaign plays some of it"));
}

TEST(DiagnosisJson, GivesAClaimAboutRawSamplesTheErrorOfItsOwnStep) {
  Diagnosis d;
  d.error_before = 0.068;
  d.error_after = 0.0032;
  d.steps = {{"", 0.0532}, {"static_nonlinearity", 0.0032}};
  Finding hum;
  hum.effect = "hum", hum.shown_in = ShownIn::samples, hum.probability = 0.95, hum.error_before = 0.068, hum.error_after = 0.0032;
  d.findings = {hum};
  EXPECT_THAT(to_json(d), HasSubstr("\"error_after\": 0.0532"));
  const std::string json = to_json(d), all = "\"error_after\": 0.0032";
  EXPECT_NE(json.find(all), std::string::npos) << "of all that was found";
  EXPECT_EQ(json.find(all), json.rfind(all)) << "of all that was found, and of nothing else";
}

TEST(WaterfallText, PrintsNoRoundingOfTheFitAsAChange) {
  diagnose::Waterfall w;
  w.start = 2.5e-3;
  w.end = 1.2e-3;
  w.unit = "V";
  w.bars = {{.effect = "creep", .as_added = 1.3e-3, .average = 1.3e-3, .low = 1.3e-3, .high = 1.3e-3, .hollow = false},
            {.effect = "delay", .as_added = 3.54e-14, .average = -3.5e-14, .low = 0.0, .high = 1e-14, .hollow = true}};
  const std::string text = waterfall_text(w);
  EXPECT_THAT(text, HasSubstr("    -1.3 mV"));
  EXPECT_THAT(text, HasSubstr("over all orders 0 [0, 0]"));
  EXPECT_THAT(text, Not(HasSubstr("e-1")));
}

TEST(RefitJson, SaysThatAnEffectIsNotNeededAndChangesWithTheSignOfTheText) {
  diagnose::Refit r;
  r.error_before = 0.05, r.error_after = 0.08;
  r.waterfall.start = 0.05, r.waterfall.end = 0.08;
  r.waterfall.bars = {{.effect = "thermal", .as_added = -0.03, .average = -0.03, .low = -0.03, .high = -0.03, .hollow = true}};
  EXPECT_THAT(refit_text(r, "thermal"), HasSubstr("the error did not fall"));
  EXPECT_THAT(refit_text(r, "thermal"), HasSubstr("+30 mV"));
  EXPECT_THAT(refit_json(r, "thermal"), testing::AllOf(HasSubstr("\"accepted\": false"), HasSubstr("the error did not fall"), HasSubstr("\"change\": 0.03")));
  EXPECT_THAT(refit_json(r, ""), testing::AllOf(HasSubstr("\"accepted\": true"), Not(HasSubstr("did not fall"))));
}

TEST(RefitText, LimitsNotNeededToTheErrorThatItJudges) {
  diagnose::Refit r;
  r.error_before = r.error_after = 0.00259;
  r.plain_before = 0.0482, r.plain_after = 0.0221;
  r.waterfall.unit = "V";
  EXPECT_THAT(refit_text(r, "mine"), testing::AllOf(HasSubstr("where each record has a gain, a zero and a decay of its own, this effect is not needed"), HasSubstr("falls from 48.2 to 22.1 mV")));
  EXPECT_THAT(refit_json(r, "mine"), testing::AllOf(HasSubstr("\"accepted\": false"), HasSubstr("falls from 48.2 to 22.1 mV")));
  r.plain_after = 0.0470;
  EXPECT_THAT(refit_text(r, "mine"), testing::AllOf(HasSubstr("the error did not fall: this effect is not needed for these records\n"), Not(HasSubstr("falls from"))));
}

TEST(WaterfallText, SpeaksOfAllOrdersOnlyWhereTheyWereAsked) {
  diagnose::Waterfall w;
  w.start = 2.5e-3;
  w.end = 1.2e-3;
  w.all_orders = false;
  w.bars = {{.effect = "creep", .as_added = 1.3e-3, .average = 1.3e-3, .low = 1.3e-3, .high = 1.3e-3, .hollow = false}};
  EXPECT_THAT(waterfall_text(w), Not(HasSubstr("over all orders")));
  EXPECT_THAT(waterfall_text(w), HasSubstr("in this order"));
}

TEST(WaterfallText, AFitThatFailsIsNoFallToNothing) {
  diagnose::Waterfall w;
  w.start = w.end = 2.5e-3;
  w.bars = {{.effect = "creep", .as_added = kMissing, .average = kMissing, .low = kMissing, .high = kMissing, .hollow = true}};
  EXPECT_THAT(waterfall_text(w), HasSubstr("over all orders ? [?, ?]"));
  EXPECT_THAT(waterfall_text(w), Not(HasSubstr("nan")));
  EXPECT_THAT(waterfall_json(w), HasSubstr("\"as_added\":null"));
}

TEST(DiffText, SaysWhereAValueHasNoLimit) {
  RunDiff d;
  CheckDelta one;
  one.case_id = "recording/recorded", one.check_id = "mre_maxima", one.unit = "%";
  one.a = 0.79, one.b = 53.0, one.delta = 52.21, one.u = 0.1;
  one.verdict_a = one.verdict_b = Verdict::pass;
  d.checks = {one};
  EXPECT_THAT(diff_text(d), HasSubstr("% (no limit)\n"));
  d.checks.front().limited = true;
  EXPECT_THAT(diff_text(d), HasSubstr("% (pass)\n"));
}

TEST(NextText, TheFileOfAReplayLiesWhereItIsWritten) {
  Diagnosis d;
  ExperimentSegment segment;
  segment.name = "fast edges";
  segment.stimulus = "replay";
  segment.t_s = {0.0, 1.0}, segment.force_N = {1.0, 2.0};
  d.next_experiment.segments = {segment};
  EXPECT_THAT(next_text(d), HasSubstr("path=FOLDER/profiles/1_fast_edges.csv"));
  EXPECT_THAT(next_text(d, "my nx"), HasSubstr("path='my nx'/profiles/1_fast_edges.csv"));
}

}  // namespace
}  // namespace forcegate
