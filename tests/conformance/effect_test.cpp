// The effects of the library and those that a campaign may be said to hide are the same, on both sides of the wall.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/model/effect.h"
#include "tests/support/campaign_effects.h"

namespace forcegate {
namespace {

// No campaign of its own: what leaves the trace of a viscous film on every record is told as such.
const std::set<std::string> kOfTheLibraryOnly = {"viscous"};

TEST(EffectNames, AreThoseOfTheCampaignFormatBothWays) {
  std::set<std::string> library;
  for (const std::string& name : EffectRegistry::instance().names())
    if (!kOfTheLibraryOnly.contains(name)) library.insert(name);
  EXPECT_EQ(library, test::kCampaignEffects);
  for (const std::string& name : kOfTheLibraryOnly) EXPECT_NE(EffectRegistry::instance().find(name), nullptr) << name << " needs no exception any more";
}

}  // namespace
}  // namespace forcegate
