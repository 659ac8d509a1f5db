// Names of what a refit moved: one name, one parameter.

#include "hil/diagnose/refit/moved_parameters.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace forcegate::diagnose
