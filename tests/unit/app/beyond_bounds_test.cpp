#include "hil/app/model/beyond_bounds.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(BeyondBounds, AStrengthThatNoSuchEffectHasIsTold) {
  const auto notes = [](const std::string& strength) {
    const auto model = parse_model("[law]\nkind = \"static\"\n[[effect]]\nname = \"dead_zone\"\nform = \"distributed\"\nshape.F0_N = 0.3\nstrength.c = " + strength + "\n", "m.toml");
    EXPECT_TRUE(model) << model.error().to_text();
    return model ? beyond_bounds_notes(*model) : std::vector<std::string>{};
  };
  EXPECT_TRUE(notes("{ value = 0.9, se = 0.1 }").empty());
  EXPECT_TRUE(notes("{ value = 3.1, max = 3.1 }").empty()) << "nobody fitted it";
  ASSERT_EQ(notes("{ value = 3.1, se = 0.1, max = 3.1 }").size(), 1u);
  EXPECT_NE(notes("{ value = 3.1, se = 0.1, max = 3.1 }").front().find("dead_zone.c = 3.10(10) lies beyond"), std::string::npos) << notes("{ value = 3.1, se = 0.1, max = 3.1 }").front();
  EXPECT_NE(notes("{ value = 2, se = 0.1 }").front().find("at an end of"), std::string::npos);
}

}  // namespace
}  // namespace forcegate
