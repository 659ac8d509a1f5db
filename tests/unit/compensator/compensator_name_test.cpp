// What an exported compensator is called, and what it is replayed on.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/compensator_check.h"
#include "hil/app/export/self_check.h"
#include "hil/model/compensator/compensator.h"
#include "tests/unit/compensator/to_and_fro.h"

namespace forcegate {
namespace {

TEST(CompensatorCheck, ARecordWithoutTheTemperatureThatTheModelNeedsIsNotReplayed) {
  Model m;
  m.law.decays = false;
  ModelEffect thermal{"thermal", "lagged", {}, {}};
  const EffectForm* form = find_form(*EffectRegistry::instance().find("thermal"), "lagged");
  ASSERT_NE(form, nullptr);
  for (const ParameterSpec& p : form->shape) thermal.shape.push_back({p.name, p.unit, p.neutral, 0, -1e9, 1e9, 0});
  for (const ParameterSpec& p : form->strength) thermal.strength.push_back({p.name, p.unit, 0.002, 0, -1e9, 1e9, 0});
  m.effects = {thermal};
  CompensatorOptions options;
  options.reference_temperature_C = 23.0;
  const auto made = make_compensator(m, options);
  ASSERT_TRUE(made) << made.error().to_text();
  Campaign cold;
  cold.name = "cold";
  cold.records = {record()};
  const auto check = check_compensator(m, *made, options.rate_Hz, cold);
  ASSERT_FALSE(check);
  EXPECT_EQ(check.error().where, "to and fro");
  EXPECT_NE(check.error().text.find("needs a temperature"), std::string::npos) << check.error().to_text();
}

// The rows that a header is held against are made for that: no record of anybody's lacks a column.
TEST(SelfCheck, AModelThatSaysNoTemperatureIsAskedForOne) {
  Model m;
  m.law.decays = false;
  m.user_effects.push_back({"mine", {{"k", "1", 0.004}}, {}, "k * F * T"});
  const auto made = make_compensator(m, {});
  ASSERT_TRUE(made) << made.error().to_text();
  const auto lacks = self_check(m, *made, 1000.0);
  ASSERT_FALSE(lacks);
  EXPECT_NE(lacks.error().hint.find("--reference-temperature"), std::string::npos) << lacks.error().to_text();
  EXPECT_EQ(lacks.error().to_text().find("--check"), std::string::npos) << lacks.error().to_text();
  m.frame.temperature_C = 23.0;
  EXPECT_TRUE(self_check(m, *made, 1000.0));
}

TEST(CompensatorName, ALongNameIsCutSoThatEveryEffectIsKnownByItsBeginning) {
  const auto id = [](const std::vector<std::string>& effects) {
    Model m;
    for (const std::string& name : effects) m.user_effects.push_back({name, {{"k", "1", 0.004}}, {}, "k * F"});
    const auto made = make_compensator(m, {});
    EXPECT_TRUE(made) << made.error().to_text();
    return made ? made->id : "";
  };
  EXPECT_EQ(id({"creep", "lag"}), "creep+lag");
  EXPECT_EQ(id({"static_nonlinearity"}), "static_nonlinear");
  EXPECT_EQ(id({"hysteresis", "static_nonlinearity"}), "hysteres+static");
  EXPECT_EQ(id({"creep", "hysteresis", "thermal"}), "creep+hyst+therm");
  EXPECT_EQ(id({"first", "second", "third", "fourth", "fifth"}), "5_effects");
}

TEST(CompensatorName, CannotOpenOrCloseACommentOfTheHeader) {
  Model m;
  m.name = "film /* no. 3 */ of /*/ today";
  const auto made = make_compensator(m, {});
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_NE(made->header.find("/* Compensator of the model \"film / * no. 3 * / of / * / today\""), std::string::npos) << made->header.substr(0, 200);
}

}  // namespace
}  // namespace forcegate
