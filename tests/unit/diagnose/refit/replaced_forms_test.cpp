// Who wrote a form into a model file is told when a fit takes another one.

#include "hil/diagnose/refit/replaced_forms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/diagnose/refit/one_law.h"
#include "hil/diagnose/refit/refit.h"
#include "tests/unit/diagnose/creeping_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Model with_forms(const std::vector<std::pair<std::string, std::string>>& effects) {
  Model m;
  for (const auto& [effect, form] : effects) m.effects.push_back({effect, form, {}, {}});
  return m;
}

TEST(ReplacedForms, AreToldOncePerEffectInAnyOrder) {
  const Model before = with_forms({{"creep", "log"}, {"dead_zone", "hard"}, {"lag", "pole"}});
  EXPECT_THAT(replaced_forms(before, with_forms({{"lag", "pole"}, {"dead_zone", "spread"}, {"dead_zone", "hard"}, {"creep", "log"}})),
              ElementsAre("dead_zone: form hard of the model was replaced by forms hard and spread, which these records ask for"));
  EXPECT_THAT(replaced_forms(before, before), IsEmpty());
  EXPECT_THAT(replaced_forms(before, with_forms({{"creep", "log"}})), IsEmpty()) << "what was left out has a note of its own";
}

TEST(ReplacedForms, AFitAndAnExportTellThem) {
  const Model library = *library_model("flexiforce");
  const auto added = refit_campaign(creeping(5), options_of(library), library, "creep");
  ASSERT_TRUE(added) << added.error().to_text();
  EXPECT_THAT(added->notes, Not(Contains(HasSubstr("was replaced"))));
  Model other = added->model;
  const EffectKind& creep = *EffectRegistry::instance().find("creep");
  const auto form = std::ranges::find_if(creep.forms, [&](const EffectForm& f) { return f.name != other.effects.front().form && f.beside.empty() && f.shape.size() == 1; });
  ASSERT_NE(form, creep.forms.end());
  const std::vector<double> shape = form->grid({}).front();
  other.effects = {model_effect(creep, *form, shape, std::vector<Estimate>(form->strength.size(), Estimate{0.01, 0.001}))};
  const auto again = refit_campaign(creeping(5), options_of(other), other, "");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_THAT(again->notes, Contains(HasSubstr("creep: form " + form->name + " of the model was replaced by")));
  const auto one = fit_one_law(creeping(5), other);
  ASSERT_TRUE(one) << one.error().to_text();
  EXPECT_THAT(one->notes, Contains(HasSubstr("without --fit the model is exported as it stands")));
}

}  // namespace
}  // namespace forcegate::diagnose
