#include "hil/app/power/mutant.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "adapters/transport/private_folder.h"

namespace forcegate {
namespace {

constexpr const char* kGain =
    "kind: bad\nbreaks: the gain is too high\npromise: accuracy\nseen by: conformance, mre_maxima\nlevels: 5 "
    "0.5 1\n"
    "unit: %\nexpect: accepted 0.5\nfile: compensator.c\n<<<<\nx\n====\ny\n>>>>\n";

TEST(Mutants, a_family_has_one_build_for_each_level_in_order) {
  const auto family = parse_mutant(kGain, "gain_pct", "gain_pct.mutant");
  ASSERT_TRUE(family) << family.error().to_text();
  ASSERT_EQ(family->size(), 3U);
  EXPECT_EQ((*family)[0].name, "gain_pct@0.5");
  EXPECT_TRUE((*family)[0].good());
  EXPECT_EQ((*family)[2].name, "gain_pct@5");
  EXPECT_FALSE((*family)[2].good());
  EXPECT_EQ((*family)[2].seen_by, (std::vector<std::string>{"conformance", "mre_maxima"}));
}

TEST(Mutants, a_defect_that_begins_later_is_a_smaller_one) {
  const auto family = parse_mutant(
      "kind: bad\nbreaks: stops\npromise: accuracy\nseen by: conformance\nlevels: 1 15 5\norder: falling\n",
      "stops", "x");
  ASSERT_TRUE(family) << family.error().to_text();
  EXPECT_EQ((*family)[0].name, "stops@15");
  EXPECT_EQ((*family)[2].name, "stops@1");
  EXPECT_FALSE(parse_mutant("kind: bad\nbreaks: b\nseen by: a\nlevels: 1 2\norder: up\n", "x", "x"));
}

TEST(Mutants, a_description_that_says_too_little_is_refused_with_its_file) {
  const auto silent = parse_mutant("kind: bad\nbreaks: something\nfile: none\n", "x", "x.mutant");
  ASSERT_FALSE(silent);
  EXPECT_NE(silent.error().text.find("seen by"), std::string::npos);
  EXPECT_EQ(silent.error().where, "x.mutant");
  EXPECT_FALSE(parse_mutant("kind: odd\nbreaks: b\nseen by: conformance\n", "x", "x"));
  EXPECT_FALSE(parse_mutant("kind: bad\nbreaks: b\nseen by: nothing\n", "x", "x"))
      << "a survivor needs a reason";
  EXPECT_FALSE(parse_mutant("kind: bad\nbreaks: b\nseen by: a\nlevels: one\n", "x", "x"));
  EXPECT_FALSE(parse_mutant("kind: bad\nwhat is this\n", "x", "x"));
}

TEST(Mutants, only_images_that_were_built_are_named) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  std::ofstream(folder->path() / "gain_pct.mutant") << kGain;
  std::ofstream(folder->path() / "gain_pct@1.native.so") << "x";
  const auto all = read_mutants(folder->path());
  ASSERT_TRUE(all) << all.error().to_text();
  ASSERT_EQ(all->size(), 3U);
  EXPECT_TRUE((*all)[0].images.empty());
  ASSERT_EQ((*all)[1].images.size(), 1U);
}

TEST(Mutants, a_folder_without_any_says_how_to_build_them) {
  auto folder = PrivateFolder::make();
  ASSERT_TRUE(folder);
  const auto none = read_mutants(folder->path());
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::usage);
  EXPECT_NE(none.error().hint.find("mutants"), std::string::npos);
}

TEST(Mutants, those_of_the_project_are_many_and_each_says_what_it_breaks) {
  const auto all = read_mutants(FORCEGATE_SOURCE_DIR "/rigs/firmware/mutants");
  ASSERT_TRUE(all) << all.error().to_text();
  std::set<std::string> bad, equivalent;
  for (const Mutant& m : *all) {
    (m.equivalent ? equivalent : bad).insert(m.family);
    EXPECT_GT(m.breaks.size(), 10U) << m.name;
    EXPECT_TRUE(m.equivalent || !m.promise.empty()) << m.name;
  }
  EXPECT_GE(bad.size(), 60U);
  EXPECT_GE(equivalent.size(), 10U);
}

}  // namespace
}  // namespace forcegate
