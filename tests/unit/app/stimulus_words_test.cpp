// KEY=VALUE of `forcegate stimulus`.

#include "hil/app/recording/stimulus.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(StimulusWords, AListMayStandInBracketsAsInAPlan) {
  for (const std::string word : {"f_Hz=1,2", "f_Hz=[1,2]", "f_Hz=[1, 2]", "f_Hz=[ 1 , 2 ]"}) {
    const auto spec = parse_stimulus_words("multisine", std::vector{word}, 1);
    ASSERT_TRUE(spec) << spec.error().to_text();
    EXPECT_EQ(spec->lists.at("f_Hz"), (std::vector{1.0, 2.0})) << word;
  }
  for (const auto& [kind, word] : {std::pair{"multisine", "f_Hz=[1,2"}, std::pair{"sine", "f_Hz=[1]"}}) {
    const auto spec = parse_stimulus_words(kind, std::vector{std::string(word)}, 1);
    ASSERT_FALSE(spec) << word;
    EXPECT_NE(spec.error().hint.find("f_Hz=1,2"), std::string::npos) << spec.error().to_text();
  }
}

}  // namespace
}  // namespace forcegate
