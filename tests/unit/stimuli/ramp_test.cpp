#include <gtest/gtest.h>

#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

TEST(Ramp, MakesNoPartOfATriangle) {
  StimulusSpec spec;
  spec.name = "ramp";
  spec.numbers["cycles"] = 1.5;
  const auto refused = make_stimulus(spec);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().text.find("cycles = 1.5 is no whole number of triangles"), std::string::npos) << refused.error().to_text();
  spec.numbers["cycles"] = 3.0;
  EXPECT_TRUE(make_stimulus(spec));
}

}  // namespace
}  // namespace forcegate
