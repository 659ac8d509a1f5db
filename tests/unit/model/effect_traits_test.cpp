#include <gtest/gtest.h>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

TEST(Library, TellsInSecondsWhatShiftsByAShape) {
  for (const std::string& name : EffectRegistry::instance().names()) {
    const EffectKind& kind = *EffectRegistry::instance().find(name);
    if (kind.traits.shift == TimeShift::none) continue;
    EXPECT_TRUE(kind.traits.timing) << name;
    if (kind.traits.shift != TimeShift::first_shape) continue;
    for (const EffectForm& form : kind.forms)
      if (!form.shape.empty()) {
        EXPECT_EQ(form.shape[0].unit, "s") << name << "/" << form.name;
      }
  }
}

TEST(Library, ADetectorFindsWhatHasNoColumns) {
  for (const EffectKind& kind : EffectRegistry::instance().all()) EXPECT_TRUE(!kind.forms.empty() || is_detected(kind)) << kind.name;
}

TEST(Library, AWitnessIsAnAngleOrACommand) {
  const EffectKind& backlash = *EffectRegistry::instance().find("backlash");
  CampaignInput campaign;
  EXPECT_FALSE(is_available(backlash, campaign));
  campaign.has_command = true;
  EXPECT_TRUE(is_available(backlash, campaign));
  campaign.has_command = false, campaign.has_theta = true;
  EXPECT_TRUE(is_available(backlash, campaign));
}

}  // namespace
}  // namespace forcegate
