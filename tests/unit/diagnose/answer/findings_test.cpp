#include "hil/diagnose/answer/findings.h"

#include <gtest/gtest.h>

#include <memory>

namespace forcegate::diagnose {
namespace {

Finding so_probable(double probability) {
  Finding f;
  f.effect = "creep";
  f.probability = probability;
  return f;
}

double suspicion_beside(double probability) {
  Diagnosis d;
  d.findings = {so_probable(probability)};
  d.refused = {{"lag", Refusal::too_small, 30.0}};
  suspect_refused({}, {}, d);
  const auto lag = std::ranges::find(d.findings, "lag", &Finding::effect);
  return lag == d.findings.end() ? -1.0 : lag->probability;
}

TEST(SuspectRefused, WhatIsNoClaimMakesNoSuspicionARemain) {
  EXPECT_EQ(suspicion_beside(0.495), suspicion_probability(Refusal::too_small, false));
  EXPECT_EQ(suspicion_beside(kClaim), suspicion_probability(Refusal::too_small, true));
}

Workspace with_own_equation(const std::string& name) {
  Workspace w;
  w.user_kinds.push_back(std::make_unique<EffectKind>());
  w.user_kinds.back()->name = name;
  w.user_kinds.back()->side = "sensor";
  w.user_kinds.back()->summary = "the equation of the model file";
  return w;
}

TEST(SuspectRefused, AUsersOwnEquationIsSuspectedAsAnyOther) {
  const Workspace w = with_own_equation("sticking");
  Diagnosis d;
  d.refused = {{"lag", Refusal::too_small, 30.0}, {"sticking", Refusal::too_small, 40.0}};
  suspect_refused(w, {}, d);
  ASSERT_EQ(d.findings.size(), 1U);
  EXPECT_EQ(d.findings[0].effect, "sticking");
  EXPECT_EQ(d.findings[0].side, "sensor");
}

TEST(KindOf, IsTheUsersOwnElseThatOfTheLibrary) {
  const Workspace w = with_own_equation("lag");
  EXPECT_EQ(kind_of(w, "lag"), w.user_kinds[0].get());
  EXPECT_EQ(kind_of(w, "creep"), EffectRegistry::instance().find("creep"));
  EXPECT_EQ(kind_of(w, "no such effect"), nullptr);
}

TEST(FindingAbout, SaysWhetherTheLevelsOfTheRecordsAreItsEvidence) {
  for (const std::string& name : EffectRegistry::instance().names()) {
    const EffectKind& kind = *EffectRegistry::instance().find(name);
    EXPECT_EQ(finding_about(kind, "V").between_records, kind.traits.between_records) << name;
  }
}

TEST(FindingAbout, SaysWhichComparisonShowsIt) {
  ChannelFacts rig;
  rig.shown_in = ShownIn::rig;
  rig.unit = "V";  // as that of the output
  const EffectKind& kind = *EffectRegistry::instance().find("backlash");
  EXPECT_TRUE(finding_about(kind, rig).of_reference());
  EXPECT_FALSE(finding_about(kind, rig).of_output());
  EXPECT_TRUE(finding_about(kind, "N").of_output());
}

TEST(Records, DifferWhereEachIsDescribedByItselfAndNotByOneForAll) {
  Diagnosis d;
  d.floor = 1.0;
  d.error_after = 1.4;
  d.plain_after = 5.0;
  EXPECT_TRUE(differs_between_records(d));
  d.single = true;
  EXPECT_FALSE(differs_between_records(d)) << "parts of one recording are no records";
  d.single = false;
  d.error_after = 1.6;
  EXPECT_FALSE(differs_between_records(d)) << "above the noise";
}

}  // namespace
}  // namespace forcegate::diagnose
