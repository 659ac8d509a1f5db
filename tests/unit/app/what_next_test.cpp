#include "hil/app/diagnose/what_next.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

Finding claim(const std::string& effect, const std::string& side) {
  Finding f;
  f.effect = effect;
  f.side = side;
  f.probability = 0.98;
  f.error_before = 0.02;
  f.error_after = 0.004;
  return f;
}

Diagnosis with(DiagnosisVerdict verdict) {
  Diagnosis d;
  d.verdict = verdict;
  d.error_before = 0.02;
  d.error_after = 0.004;
  d.records.resize(3);
  d.force_range_N = 4.0;
  return d;
}

constexpr DiagnosisVerdict kNone = DiagnosisVerdict::none, kKnown = DiagnosisVerdict::known, kUnknown = DiagnosisVerdict::unknown;

TEST(WhatNext, TakesAFoundEffectIntoTheModelAndNeverTwice) {
  Diagnosis d = with(kKnown);
  d.findings = {claim("creep", "sensor")};
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::add);
  EXPECT_EQ(after_diagnosis(d, {.page = true}).word, "creep");
  EXPECT_NE(after_diagnosis(d, {.model_file = true, .in_model = {"creep"}}).step, Step::add);
}

TEST(WhatNext, AnOutputThatIsLateBehindTheModelsLagIsSetEarlierFirst) {
  Diagnosis d = with(kKnown);
  d.findings = {claim("static_nonlinearity", "sensor"), claim("delay", "instrument")};
  d.findings.back().form = kBehindLag;
  d.findings.back().parameters = {{"delay_s", 0.0231, 0.0003, "s"}};
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::align);
  EXPECT_EQ(after_diagnosis(d, {}).late_s, 0.0231);
  d.findings.back().probability = 0.4;
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::add);
}

TEST(WhatNext, WhatIsNotSeparableAsksForTheExperimentWhateverWasDrawn) {
  Diagnosis d = with(kUnknown);
  d.not_separable = {{"creep", "self_heating"}};
  for (const bool page : {false, true}) EXPECT_EQ(after_diagnosis(d, {.page = page}).step, Step::experiment);
  // no short segment parts them: the experiment is not asked for again
  EXPECT_EQ(after_diagnosis(d, {.experiment = true}).step, Step::record);
}

TEST(WhatNext, NothingMissingEndsInAModelAndThatInFirmware) {
  Diagnosis d = with(kNone);
  d.next_experiment.segments.resize(1);  // the evidence of the ranking leaves rivals open that nobody claims
  for (const bool page : {false, true}) {
    EXPECT_EQ(after_diagnosis(d, {.page = page}).step, Step::fit);
    EXPECT_EQ(after_diagnosis(d, {.page = page, .is_exportable = [] { return true; }}).step, Step::compensate);
    EXPECT_EQ(after_diagnosis(d, {.page = page, .model_file = true, .is_exportable = [] { return true; }}).step, Step::compensate);
    const WhatNext refused = after_diagnosis(d, {.page = page, .model_file = true, .is_exportable = [] { return false; }});
    EXPECT_EQ(refused.step, Step::explain);
    EXPECT_EQ(refused.word, "none");
  }
}

TEST(WhatNext, WhatNoLibraryEffectExplainsIsLookedAtOnceAndThenExplained) {
  const Diagnosis d = with(kUnknown);
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::page);
  for (const bool own : {false, true}) {
    const WhatNext seen = after_diagnosis(d, {.page = true, .model_file = own, .is_exportable = [] { return true; }});
    EXPECT_EQ(seen.step, Step::explain);
    EXPECT_EQ(seen.word, "unknown");
  }
}

TEST(WhatNext, AModelThatGrewIsExportedThoughNotAllIsUnderstood) {
  const Diagnosis d = with(kUnknown);
  Standing at{.model_file = true, .in_model = {"creep"}, .is_exportable = [] { return true; }};
  EXPECT_EQ(after_diagnosis(d, at).step, Step::page);
  at.page = true;
  EXPECT_EQ(after_diagnosis(d, at).step, Step::compensate);
  at.is_exportable = [] { return false; };
  EXPECT_EQ(after_diagnosis(d, at).word, "unknown");
}

TEST(WhatNext, RivalsThatWereRefusedAreNoExperiment) {
  Diagnosis d = with(kUnknown);
  d.next_experiment.segments.resize(1);
  d.findings = {claim("hysteresis", "sensor"), claim("static_nonlinearity", "sensor")};
  d.findings[0].probability = 0.20, d.findings[1].probability = 0.18;
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true}).word, "unknown");
  d.findings[0].probability = 0.36;  // too small for these records, or another strength in each
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::experiment);
}

TEST(WhatNext, AClaimOnTheInstrumentIsMendedThereWhateverElseCameUp) {
  Diagnosis d = with(kKnown);
  d.next_experiment.segments.resize(1);
  d.findings = {claim("hum", "instrument"), claim("dead_zone", "sensor")};
  d.findings[0].shown_in = ShownIn::samples;
  d.findings[1].probability = 0.2;
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true}).word, "instrument");
}

TEST(WhatNext, WhatTheModelHasNoPlaceForNamesTheSideThatIsToBeMended) {
  Diagnosis d = with(kKnown);
  d.findings = {claim("outliers", "instrument")};
  d.findings[0].shown_in = ShownIn::samples;  // seen in the samples: no term of a model
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true}).word, "instrument");
  d.findings = {claim("drift", "sensor")};
  EXPECT_EQ(after_diagnosis(d, {.page = true}).word, "drift");
}

Diagnosis with_suspicion() {
  Diagnosis d = with(kNone);
  d.error_before = d.error_after = d.floor = 0.002;
  Finding f = claim("humidity", "sensor");
  f.probability = 0.25;
  f.effect_rms = 0.1;
  f.between_records = true;
  d.findings = {f};
  return d;
}

TEST(WhatNext, ASuspicionBesideANoneIsLookedAtAndRecordedAndNotExported) {
  const Diagnosis d = with_suspicion();
  const auto exportable = [] { return true; };
  EXPECT_EQ(after_diagnosis(d, {.is_exportable = exportable}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true, .is_exportable = exportable}).step, Step::experiment);
  EXPECT_EQ(after_diagnosis(d, {.experiment = true, .is_exportable = exportable}).step, Step::record);
}

TEST(WhatNext, ARecordFarAboveItsNoiseIsLookedAtBeforeAnythingIsExported) {
  Diagnosis d = with(kNone);
  d.far_above = {{"r05", 3.7}};
  const auto exportable = [] { return true; };
  EXPECT_EQ(after_diagnosis(d, {.is_exportable = exportable}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true, .is_exportable = exportable}).step, Step::compensate);
}

TEST(WhatNext, AClaimThatHeldOutRecordsGainNothingByAsksForMoreOfThem) {
  Diagnosis d = with(kKnown);
  d.error_after = 2.0 * d.error_before;
  d.findings = {claim("thermal", "sensor")};
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::page);
  EXPECT_EQ(after_diagnosis(d, {.page = true}).step, Step::record);  // "explain sensor" would send to add
}

TEST(WhatNext, WhatAddRefusesIsNotAskedOfTheDiagnosisThatWouldHaveItAdded) {
  Diagnosis d = with(kKnown);
  d.findings = {claim("creep", "sensor")};
  EXPECT_TRUE(leads_to_add(d, "creep"));
  EXPECT_FALSE(leads_to_add(d, "thermal"));
  d.error_after = 2.0 * d.error_before;
  EXPECT_FALSE(leads_to_add(d, "creep"));
}

TEST(WhatNext, APlanIsNamedOnlyWhereItPlaysWhatWasAskedFor) {
  Diagnosis d = with(kUnknown);
  d.not_separable = {{"delay", "lag", "rc"}};
  EXPECT_EQ(plan_that_settles(d), "");
  d.not_separable = {{"creep", "thermal"}};
  EXPECT_EQ(plan_that_settles(d), "campaign");
  EXPECT_EQ(plan_that_settles(with_suspicion()), "");
  EXPECT_EQ(plan_that_settles(with(kNone)), "campaign");
}

TEST(WhatNext, RecordingsWithoutAnInputAreNeverFitted) {
  Diagnosis d = with(kNone);
  d.force_range_N = 0.0;
  EXPECT_EQ(after_diagnosis(d, {}).step, Step::explain);
}

TEST(WhatNext, AsksExportItselfWhetherAModelCanBecomeFirmware) {
  EXPECT_TRUE(export_offer("flexiforce", nullptr).has_value());
  EXPECT_FALSE(export_offer("no such file.toml", nullptr).has_value());
}

TEST(WhatNext, AStepIsNotWrittenOverTheOneBeforeIt) {
  EXPECT_EQ(better_model_name(""), "better.toml");
  EXPECT_EQ(better_model_name("fsr"), "better.toml");
  EXPECT_EQ(better_model_name("better.toml"), "better2.toml");
  EXPECT_EQ(better_model_name("out/better2.toml"), "out/better3.toml");
  EXPECT_EQ(better_model_name("betterment.toml"), "better.toml");
}

}  // namespace
}  // namespace forcegate
