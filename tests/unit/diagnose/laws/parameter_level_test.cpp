#include "hil/diagnose/laws/parameter_level.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

// n records over frequency, amplitude, mean, rest and temperature; b = 0.0019 f + 0.0056 with relative scatter.
ParameterQuestion records(std::uint64_t seed, int n, double scatter) {
  Rng rng(seed, "records");
  ParameterQuestion q;
  q.name = "b";
  q.unit = "1/s";
  q.covariates = {{"f", "Hz", {}}, {"A", "N", {}}, {"m", "N", {}}, {"rest", "s", {}}, {"T", "degC", {}}};
  for (int i = 0; i < n; ++i) {
    const double f = rng.uniform(0.05, 4.0);
    q.covariates[0].value.push_back(f);
    q.covariates[1].value.push_back(rng.uniform(0.4, 1.8));
    q.covariates[2].value.push_back(rng.uniform(1.7, 3.5));
    q.covariates[3].value.push_back(std::exp(rng.uniform(5.0, 9.0)));
    q.covariates[4].value.push_back(rng.normal(23.0, 2.0));
    q.value.push_back(0.0019 * f + 0.0056 + scatter * rng.normal());
  }
  return q;
}

const LawTerm kF{TermForm::linear, "f", {}};

TEST(ParameterLevel, TheLawOfTheDecayRateIsRecovered) {
  const auto a = missing_dependence(records(3, 20, 0.0004));
  ASSERT_TRUE(a) << a.error().to_text();
  ASSERT_EQ(a->added.size(), 1u) << a->sentence;
  EXPECT_EQ(to_string(a->added[0].found.term), "f");
  ASSERT_EQ(a->law.size(), 2u);
  EXPECT_NEAR(a->law[0].value, 0.0056, 4.0 * a->law[0].u);
  EXPECT_NEAR(a->law[1].value, 0.0019, 4.0 * a->law[1].u);
  EXPECT_LT(a->law[1].u, 2e-4);
  EXPECT_LT(a->loo_after, 0.5 * a->loo_before);
}

TEST(ParameterLevel, APlantedDependenceOnTheMeanIsFoundBesideTheLaw) {
  ParameterQuestion q = records(5, 20, 0.0004);
  q.law = {kF};
  for (std::size_t i = 0; i < q.value.size(); ++i) q.value[i] += 0.0012 * q.covariates[2].value[i];
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a) << a.error().to_text();
  ASSERT_FALSE(a->added.empty()) << a->sentence;
  EXPECT_EQ(a->added[0].found.term.covariate, "m") << a->sentence;
  EXPECT_NE(a->sentence.find("lacks"), std::string::npos);
}

TEST(ParameterLevel, ALawWhoseTermsSayTheSameIsRefused) {
  ParameterQuestion q = records(5, 20, 0.0004);
  q.covariates.push_back({"mHz", "mHz", {}});
  for (const double f : q.covariates[0].value) q.covariates.back().value.push_back(1e3 * f);
  q.law = {kF, {TermForm::linear, "mHz", {}}};
  const auto a = missing_dependence(q);
  ASSERT_FALSE(a);
  EXPECT_EQ(a.error().code, ErrorCode::usage);
  EXPECT_NE(a.error().text.find("mHz says nothing"), std::string::npos) << a.error().to_text();
}

TEST(ParameterLevel, FormsThatTheTableCannotTellApartAreNamed) {
  ParameterQuestion q = records(5, 20, 0.0002);
  q.law = {kF};
  for (std::size_t i = 0; i < q.value.size(); ++i) q.value[i] += 0.0012 * q.covariates[2].value[i];
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a);
  ASSERT_FALSE(a->added.empty());
  EXPECT_FALSE(a->added[0].fits_as_well.empty());  // m, m^2 and ln m hardly differ over a factor of two
}

// f T goes with f where T hardly varies, and leaves seven times the error.
TEST(ParameterLevel, AFormThatLeavesClearlyMoreIsNotOfTheSameSize) {
  ParameterQuestion q = records(5, 20, 0.00005);
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a);
  ASSERT_EQ(a->added.size(), 1u) << a->sentence;
  EXPECT_EQ(to_string(a->added[0].found.term), "f");
  EXPECT_GT(a->ranking[1].loo_after, 3.0 * a->ranking[0].loo_after) << to_string(a->ranking[1].term);
  EXPECT_TRUE(a->added[0].fits_as_well.empty()) << a->sentence;
  EXPECT_EQ(a->sentence.find("of the same size"), std::string::npos) << a->sentence;
}

TEST(ParameterLevel, WithoutADependenceTheAnswerSaysHowLargeOneWouldHaveToBe) {
  ParameterQuestion q = records(7, 20, 0.0005);
  q.law = {kF};
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a);
  EXPECT_TRUE(a->added.empty()) << a->sentence;
  EXPECT_NE(a->sentence.find("no further dependence of b is significant with 20 records"), std::string::npos)
      << a->sentence;
  EXPECT_GT(a->smallest_share, 0.2);
  EXPECT_LT(a->smallest_share, 0.8);
}

// Exact for exchangeable errors: 400 tables without a further dependence give at most alpha + 3 binomial sd of claims.
TEST(ParameterLevel, FalseDependencesStayAtTheStatedRateOverManySeeds) {
  int claims = 0;
  constexpr int kTables = 400;
  for (int k = 0; k < kTables; ++k) {
    ParameterQuestion q = records(1000 + static_cast<std::uint64_t>(k), 20, 0.0005);
    q.law = {kF};
    q.permutations = 199;
    q.seed = static_cast<std::uint64_t>(k);
    const auto a = missing_dependence(q);
    ASSERT_TRUE(a);
    claims += !a->added.empty();
  }
  EXPECT_LE(claims, 0.05 * kTables + 3.0 * std::sqrt(0.05 * 0.95 * kTables));
  EXPECT_GE(claims, 2);  // the test is exact, not dead
}

TEST(ParameterLevel, TheRateHoldsForSkewErrorsToo) {
  int claims = 0;
  constexpr int kTables = 200;
  for (int k = 0; k < kTables; ++k) {
    ParameterQuestion q = records(5000 + static_cast<std::uint64_t>(k), 16, 0.0);
    Rng rng(static_cast<std::uint64_t>(k), "skew");
    for (double& v : q.value) v += 0.0004 * std::exp(rng.normal());
    q.law = {kF};
    q.permutations = 199;
    const auto a = missing_dependence(q);
    ASSERT_TRUE(a);
    claims += !a->added.empty();
  }
  EXPECT_LE(claims, 0.05 * kTables + 3.0 * std::sqrt(0.05 * 0.95 * kTables));
}

TEST(ParameterLevel, RecordsWithLargeUncertaintyCountLess) {
  ParameterQuestion q = records(9, 24, 0.0003);
  q.u.assign(24, 0.0003);
  for (std::size_t i = 0; i < 6; ++i) {
    q.value[i] += i % 2 ? 0.02 : -0.02;
    q.u[i] = 0.02;
  }
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a);
  ASSERT_FALSE(a->added.empty()) << a->sentence;
  EXPECT_EQ(to_string(a->added[0].found.term), "f");
  EXPECT_NEAR(a->law[1].value, 0.0019, 2e-4);
}

TEST(ParameterLevel, TheRatioIsALawOfItsReciprocal) {
  ParameterQuestion q = records(11, 18, 0.0);
  q.name = "q";
  Rng rng(11, "q");
  for (std::size_t i = 0; i < q.value.size(); ++i) {
    const double A = q.covariates[1].value[i];
    q.value[i] = 1.0 / (1.0 + 1.377 * A * A + 0.05 * rng.normal());
  }
  q.scale = ResponseScale::reciprocal;
  const auto a = missing_dependence(q);
  ASSERT_TRUE(a);
  ASSERT_EQ(a->added.size(), 1u) << a->sentence;
  EXPECT_EQ(to_string(a->added[0].found.term), "A^2");
  EXPECT_NEAR(a->law[1].value, 1.377, 0.1);
}

TEST(ParameterLevel, TooFewRecordsAreRefusedWithAReason) {
  const auto a = missing_dependence(records(1, 5, 0.001));
  ASSERT_FALSE(a);
  EXPECT_NE(a.error().text.find("5 records"), std::string::npos);
  EXPECT_FALSE(a.error().hint.empty());
}

TEST(ParameterLevel, TheSameTableGivesTheSameAnswer) {
  const auto a = missing_dependence(records(3, 20, 0.001)), b = missing_dependence(records(3, 20, 0.001));
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->ranking.size(), b->ranking.size());
  for (std::size_t i = 0; i < a->ranking.size(); ++i) EXPECT_EQ(a->ranking[i].p, b->ranking[i].p);
}

TEST(ParameterLevel, TermsReadBackAsTheyArePrinted) {
  for (const char* text : {"f", "ln f", "1/f", "f^2", "f m"}) {
    const auto term = parse_term(text);
    ASSERT_TRUE(term) << text;
    EXPECT_EQ(to_string(*term), text);
  }
  EXPECT_EQ(to_string(*parse_term("f*m")), "f m");
  EXPECT_FALSE(parse_term("f^3"));
  EXPECT_FALSE(parse_term(""));
}

}  // namespace
}  // namespace forcegate
