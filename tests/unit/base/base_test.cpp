#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hil/base/digest.h"
#include "hil/base/plain_number.h"
#include "hil/base/portable_math.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/base/units.h"

namespace forcegate {
namespace {

TEST(PortableMath, AgreesWithTheLibraryToItsStatedError) {
  Rng rng(7);
  for (int i = 0; i < 200000; ++i) {
    const double x = rng.uniform(-1e4, 1e4);
    EXPECT_NEAR(portable::sin(x), std::sin(x), 2e-15);
    EXPECT_NEAR(portable::cos(x), std::cos(x), 2e-15);
    const double e = rng.uniform(-700, 700);
    EXPECT_NEAR(portable::exp(e) / std::exp(e), 1.0, 1e-15);
    const double l = std::exp(rng.uniform(-50, 50));
    EXPECT_NEAR(portable::log(l), std::log(l), 1e-15 * std::max(1.0, std::fabs(std::log(l))));
  }
  EXPECT_EQ(portable::exp(-1000), 0.0);
  EXPECT_TRUE(std::isinf(portable::exp(1000)));
  EXPECT_TRUE(std::isnan(portable::log(-1)));
}

TEST(Rng, NormalHasTheMomentsAndTailsOfAGaussian) {
  Rng rng(1, "moments");
  const int n = 2000000;
  double s1 = 0, s2 = 0, s4 = 0;
  int beyond3 = 0;
  for (int i = 0; i < n; ++i) {
    const double v = rng.normal();
    s1 += v;
    s2 += v * v;
    s4 += v * v * v * v;
    beyond3 += std::fabs(v) > 3.0;
  }
  EXPECT_NEAR(s1 / n, 0.0, 4.0 / std::sqrt(n));
  EXPECT_NEAR(s2 / n, 1.0, 0.006);
  EXPECT_NEAR(s4 / n, 3.0, 0.04);
  EXPECT_NEAR(beyond3 / double(n), 0.0026998, 0.00015);
}

TEST(Rng, StreamsOfOneSeedDiffer) {
  EXPECT_NE(Rng(1, "a").next(), Rng(1, "b").next());
  EXPECT_EQ(Rng(1, "a").next(), Rng(1, "a").next());
}

TEST(Text, ControlBytesAndBrokenUtf8NeverPass) {
  EXPECT_EQ(printable_utf8("a\x01"
                           "b"),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(printable_utf8("\xC3\xA9\n"), "\xC3\xA9\n");
  EXPECT_EQ(printable_utf8("\xC3("), "\xEF\xBF\xBD(");
  EXPECT_EQ(printable_utf8("\xED\xA0\x80").find("\xED\xA0"), std::string::npos);
}

TEST(Text, UncertaintyInParenthesesFollowsTheDigitRule) {
  EXPECT_EQ(plain_number(0.00123456), "0.00123");
  EXPECT_EQ(plain_number(12.345), "12.3");
  EXPECT_EQ(plain_number(999.6), "1000");
  EXPECT_EQ(plain_number(-14532.4), "-14532");
  EXPECT_EQ(with_uncertainty(4.5213, 0.3), "4.5(3)");
  EXPECT_EQ(with_uncertainty(4.5213, 0.12), "4.52(12)");
  EXPECT_EQ(with_uncertainty(4.5213, 0.0996), "4.52(10)");
  EXPECT_EQ(with_uncertainty(-1e-26, 1.2e-25), "-0.1(12)e-25");
  EXPECT_EQ(with_uncertainty(2.5e-12, 3e-13), "2.5(3)e-12");
  EXPECT_EQ(with_uncertainty(4.5, 0.0), "4.5");
  EXPECT_EQ(with_uncertainty(1234.0, 30.0), "1230(30)");
  EXPECT_EQ(with_uncertainty(-3.0, 90.0), "0(90)");
  EXPECT_EQ(with_uncertainty(-0.001, 0.03), "0.00(3)");
  EXPECT_EQ(with_uncertainty(-0.5, 3.0), "0(3)");
  EXPECT_EQ(with_uncertainty(-0.01, 2.5), "0.0(25)");
  EXPECT_EQ(with_uncertainty(-0.011, 0.03), "-0.01(3)");
  EXPECT_EQ(with_uncertainty(-0.0, 0.0), "0");
  EXPECT_EQ(with_uncertainty(-6.74e27, 9e26), "-6.7(9)e27");
}

TEST(PlainNumber, SoManyTimesHasTwoDigitsAndNoExponent) {
  EXPECT_EQ(so_many_times(2.84), "2.8 times");
  EXPECT_EQ(so_many_times(99.4), "99 times");
  EXPECT_EQ(so_many_times(131.4), "131 times");
  EXPECT_EQ(so_many_times(20461.0), "20461 times");
}

TEST(Text, OnlyAToZBecomeSmall) { EXPECT_EQ(ascii_lower("t_MS (\xc3\x84 [Z])"), "t_ms (\xc3\x84 [z])"); }

TEST(Text, ATypingMistakeIsSuggestedAndNonsenseIsNot) {
  const std::vector<std::string> names{"sine", "multisine", "chirp"};
  EXPECT_EQ(nearest_name("sien", names), "sine");
  EXPECT_EQ(nearest_name("qqqqqqq", names), "");
}

TEST(Units, SuffixGivesFactorToTheCanonicalUnit) {
  const auto c = split_unit_suffix("F_ref_mN");
  ASSERT_TRUE(c);
  EXPECT_EQ(c->name, "F_ref");
  EXPECT_EQ(c->unit.canonical, "N");
  EXPECT_DOUBLE_EQ(c->unit.factor, 1e-3);
  EXPECT_FALSE(split_unit_suffix("F_ref"));
  EXPECT_NEAR(find_unit("degF")->factor * 212 + find_unit("degF")->offset, 100.0, 1e-12);
}

// The empty input's value is the published one of XXH3-128 with seed 0.
TEST(SampleDigest, DependsOnTheBytesAndNotOnHowTheyAreCut) {
  SampleDigest d;
  EXPECT_EQ(d.hex(), "99aa06d3014798d86001c324468d497f");
  const std::string bytes(3000, 'x');
  d.update(bytes.data(), bytes.size());
  const std::string whole = d.hex();
  d.update(bytes.data(), 7);
  d.update(bytes.data() + 7, bytes.size() - 7);
  EXPECT_EQ(d.hex(), whole);
  d.update(bytes.data(), bytes.size() - 1);
  EXPECT_NE(d.hex(), whole);
}

TEST(Digest, MatchesThePublishedTestVector) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Text, OrdersFileNamesAsPeopleDo) {
  std::vector<std::string> names = {"run10.csv", "run2.csv", "run.csv", "a1b10", "a1b9", "a01b9", "r007", "r7", "r7a", "R7", "", "9", "10"};
  std::ranges::sort(names, natural_less);
  const std::vector<std::string> wanted = {"", "9", "10", "R7", "a01b9", "a1b9", "a1b10", "r007", "r7", "r7a", "run.csv", "run2.csv", "run10.csv"};
  EXPECT_EQ(names, wanted);
  EXPECT_TRUE(natural_less("r99999999999999999998", "r99999999999999999999")) << "numbers of any length";
}

TEST(Text, AnOrderOfNamesIsAnOrder) {
  Rng rng(5, "names");
  std::vector<std::string> names;
  for (int i = 0; i < 60; ++i) {
    std::string name;
    for (int k = 0; k < 5; ++k) name += "01a9."[static_cast<std::size_t>(rng.uniform() * 5.0)];
    names.push_back(name);
  }
  for (const std::string& a : names) {
    EXPECT_FALSE(natural_less(a, a));
    for (const std::string& b : names) {
      if (a != b) {
        EXPECT_NE(natural_less(a, b), natural_less(b, a)) << a << " " << b;
      }
      for (const std::string& c : names)
        if (natural_less(a, b) && natural_less(b, c)) {
          EXPECT_TRUE(natural_less(a, c)) << a << " " << b << " " << c;
        }
    }
  }
}

TEST(PlainNumber, OddsBeyondWhatAClaimStatesAreOver) {
  EXPECT_EQ(odds_text(1.5), "1.5");
  EXPECT_EQ(odds_text(49.0), "49");
  EXPECT_EQ(odds_text(784.0), "over 50");
}

}  // namespace
}  // namespace forcegate
