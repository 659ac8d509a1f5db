#include "hil/app/model/weak_addition.h"

#include <gmock/gmock.h>

namespace forcegate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

diagnose::Refit refit(double k, double u, double p, double error_after, double plain_after) {
  diagnose::Refit out;
  UserEffect mine{"mine", {{"k", "", k, u, -1e300, 1e300, 0.0}, {"p", "", p, 0.1, 0.5, 3.0, 0.0}}, {}, "k * F^p"};
  mine.parameters.back().written = 1.5;
  out.model.user_effects = {mine};
  out.error_before = 0.0179, out.error_after = error_after;
  out.plain_before = 0.0847, out.plain_after = plain_after;
  return out;
}

TEST(WeakAddition, WhatIsPlainlyThereIsNotWarnedOf) {
  const WeakAddition w = weak_addition(refit(0.06, 0.0002, 1.4, 0.0035, 0.006), "mine");
  EXPECT_TRUE(w.is_shown);
  EXPECT_THAT(w.warnings, IsEmpty());
  EXPECT_THAT(weak_addition(refit(0.0, 0.1, 3.0, 0.0179, 0.09), "").warnings, IsEmpty()) << "a refit adds nothing";
}

TEST(WeakAddition, AStrengthOfNothingAShapeAtItsEndAndErrorsThatStayAreTold) {
  const WeakAddition w = weak_addition(refit(-0.0002, 0.0006, 3.0, 0.0178, 0.0853), "mine");
  EXPECT_FALSE(w.is_shown);
  EXPECT_THAT(w.warnings, ElementsAre(HasSubstr("mine.p = 3.00(10) lies at an end of what it may be (0.5 to 3)"),
                                      HasSubstr("mine.k = -0.0002(6) lies within two standard errors of 0"), HasSubstr("the error hardly falls"), HasSubstr("leave mine out")));
}

TEST(WeakAddition, APartOfAnEquationThatIsNoneIsToldThoughAnotherIsPlain) {
  diagnose::Refit r = refit(0.06, 0.0002, 1.4, 0.0035, 0.006);
  r.model.user_effects.front().parameters.push_back({"c", "", -0.0002, 0.0005, -1e300, 1e300, 0.0});
  const WeakAddition w = weak_addition(r, "mine");
  EXPECT_TRUE(w.is_shown);
  EXPECT_THAT(w.warnings, ElementsAre(HasSubstr("mine.c = -0.0002(5) lies within two standard errors of 0: these records do not show that part")));
  r.model.user_effects.front().parameters.front().value = 0.0001;  // columns that are nearly the same share one strength
  EXPECT_THAT(weak_addition(r, "mine").warnings, IsEmpty());
}

TEST(WeakAddition, AnEndOfTheRangeAloneIsShownAllTheSame) {
  const WeakAddition w = weak_addition(refit(0.06, 0.0002, 0.5, 0.0035, 0.006), "mine");
  EXPECT_TRUE(w.is_shown);
  EXPECT_THAT(w.warnings, ElementsAre(HasSubstr("write another value or wider bounds")));
}

TEST(WeakAddition, AGainThatFollowsTheTemperatureAtOnceIsNoWonder) {
  const EffectKind* thermal = EffectRegistry::instance().find("thermal");
  ASSERT_NE(thermal, nullptr);
  const auto form = std::ranges::find_if(thermal->forms, [](const EffectForm& f) { return !f.shape.empty() && f.shape.front().name == "tau_s"; });
  ASSERT_NE(form, thermal->forms.end());
  const auto warned = [&](double tau_s) {
    diagnose::Refit r = refit(0.06, 0.0002, 1.0, 0.0035, 0.006);
    ModelEffect effect = model_effect(*thermal, *form, std::vector{tau_s}, std::vector<Estimate>(form->strength.size(), Estimate{0.01, 1e-4}));
    effect.shape.front().se = 4.0;
    r.model.effects = {effect};
    return weak_addition(r, "thermal").warnings;
  };
  ASSERT_EQ(form->shape.front().minimum, 0.0);
  EXPECT_THAT(warned(0.0), IsEmpty());
  EXPECT_THAT(warned(form->shape.front().maximum), ElementsAre(HasSubstr("lies at an end")));
}

// Columns that are nearly the same share one strength, and none of them is sure of its part.
TEST(WeakAddition, SeveralUnsureStrengthsThatLowerTheErrorAreShown) {
  const EffectKind* curve = EffectRegistry::instance().find("static_nonlinearity");
  ASSERT_NE(curve, nullptr);
  const EffectForm* form = find_form(*curve, "polynomial");
  ASSERT_NE(form, nullptr);
  for (const bool falls : {true, false}) {
    diagnose::Refit r;
    r.model.effects = {model_effect(*curve, *form, {}, std::vector<Estimate>(form->strength.size(), Estimate{0.1, 0.06}))};
    r.error_before = r.plain_before = 0.0258;
    r.error_after = r.plain_after = falls ? 0.0031 : 0.0257;
    const WeakAddition w = weak_addition(r, "static_nonlinearity");
    EXPECT_EQ(w.is_shown, falls);
    EXPECT_EQ(w.warnings.empty(), falls);
  }
}

TEST(WeakAddition, WithoutAnErrorThatFallsNothingIsShown) {
  const WeakAddition w = weak_addition(refit(0.06, 0.0002, 1.4, 0.0179, 0.0847), "mine");
  EXPECT_FALSE(w.is_shown);
  EXPECT_THAT(w.warnings, IsEmpty()) << "add says that the error did not fall";
}

}  // namespace
}  // namespace forcegate
