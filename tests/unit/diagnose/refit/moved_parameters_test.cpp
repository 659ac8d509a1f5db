// Names of what a refit moved: one name, one parameter.

#include "hil/diagnose/refit/moved_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace forcegate::diagnose {
namespace {

ModelEffect of_form(const std::string& effect, const std::string& form, double shape, double strength) {
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  const EffectForm* found = find_form(*kind, form);
  const std::vector<double> shapes(found->shape.size(), shape);
  const std::vector<Estimate> strengths(found->strength.size(), {strength, 0.01});
  return model_effect(*kind, *found, shapes, strengths);
}

TEST(MovedParameters, NamesTheFormWhereAnEffectHasSeveralAndTheShapeWhereAFormDoes) {
  const std::vector<ModelEffect> after = {of_form("hysteresis", "play_bank", 0.0, 0.1), of_form("hysteresis", "play_bank", 1.0, 0.2),
                                          of_form("lag", "two_poles", 0.05, 0.6), of_form("lag", "diffusive", 0.06, 0.1),
                                          of_form("creep", "power_law", 0.1, 0.02)};
  const std::vector<ModelEffect> before = {of_form("hysteresis", "play_bank", 1.0, 0.7), of_form("hysteresis", "play_bank", 0.0, 0.4)};
  const std::vector<ParameterMove> moves = moved_parameters(before, after);
  std::set<std::string> names;
  for (const ParameterMove& m : moves) {
    EXPECT_TRUE(names.insert(m.name).second) << m.name;
    if (m.name == "hysteresis.play_bank[kept=0].w3") {
      EXPECT_EQ(m.before, 0.4);
    }
    if (m.name == "hysteresis.play_bank[kept=1].w3") {
      EXPECT_EQ(m.before, 0.7);
    }
  }
  for (const char* name : {"hysteresis.play_bank[kept=0].w3", "hysteresis.play_bank[kept=1].w3", "lag.two_poles.c", "lag.diffusive.c"})
    EXPECT_TRUE(names.contains(name)) << name;
  EXPECT_TRUE(names.contains("creep." + after.back().strength.front().name));
}

double before_of(const std::vector<ParameterMove>& moves, const std::string& name) {
  for (const ParameterMove& m : moves)
    if (m.name == name) return m.before;
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(MovedParameters, OfTwoEntriesOfOneFormEachHasItsOwnPast) {
  const std::vector<ModelEffect> before = {of_form("dead_zone", "hard", 0.1, 0.7), of_form("dead_zone", "hard", 2.0, -0.4)};
  const std::vector<ModelEffect> after = {of_form("dead_zone", "hard", 1.5, -0.5), of_form("dead_zone", "hard", 0.12, 0.6)};
  const std::vector<ParameterMove> moves = moved_parameters(before, after);
  EXPECT_EQ(before_of(moves, "dead_zone.hard[F0_N=1.5].c"), -0.4);
  EXPECT_EQ(before_of(moves, "dead_zone.hard[F0_N=1.5].F0_N"), 2.0);
  EXPECT_EQ(before_of(moves, "dead_zone.hard[F0_N=0.12].c"), 0.7);
  EXPECT_EQ(before_of(moves, "dead_zone.hard[F0_N=0.12].F0_N"), 0.1);
}

TEST(MovedParameters, AFittedShapeOfWhatIsNewIsTold) {
  ModelEffect lag = of_form("lag", "one_pole", 0.05, 0.9);
  for (const double se : {0.0, 0.002}) {
    lag.shape.front().se = se;
    const std::vector<ParameterMove> moves = moved_parameters({}, {lag});
    ASSERT_EQ(moves.size(), se > 0.0 ? 2u : 1u);
    EXPECT_EQ(moves.front().before, 0.0);
    if (se > 0.0) {
      EXPECT_EQ(moves.back().name, "lag.tau_s");
      EXPECT_TRUE(std::isnan(moves.back().before));
    }
  }
}

TEST(MovedParameters, AShapeThatItsFormTakesFromAGridIsToldThoughItWasNotFitted) {
  const std::vector<ParameterMove> moves = moved_parameters({}, {of_form("creep", "carried", 300.0, 0.05)});
  ASSERT_EQ(moves.size(), 2u);
  EXPECT_EQ(moves.back().name, "creep.tau_s");
  EXPECT_EQ(moves.back().after, 300.0);
}

}  // namespace
}  // namespace forcegate::diagnose
