#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// 12 bits over 10 V: the highest weigh too much or too little, as shares of the range.
Sensor converter(double half, double quarter, double eighth = 0.0) {
  return [=](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) {
      const double x = 2.0 * f + 0.2;
      U.push_back(x + 10.0 * ((x >= 5.0 ? half : 0.0) + (std::fmod(x, 5.0) >= 2.5 ? quarter : 0.0) + (std::fmod(x, 2.5) >= 1.25 ? eighth : 0.0)));
    }
    return U;
  };
}

const Finding* claimed(const Diagnosis& d) {
  const auto found = std::ranges::find_if(d.findings, [](const Finding& f) { return f.effect == "adc_codes" && f.probability >= 0.5; });
  return found == d.findings.end() ? nullptr : &*found;
}

TEST(Converter, SmallErrorsOfBitsAreThoseOfTheReading) {
  const Diagnosis d = answer(make_campaign(81, converter(0.004, -0.002)));
  ASSERT_NE(claimed(d), nullptr) << told(d);
  EXPECT_LT(claimed(d)->error_after, 0.6 * claimed(d)->error_before);
}

TEST(Converter, LargeErrorsMoveTheReadingPastTheCodeThatMadeIt) {
  const Diagnosis d = answer(make_campaign(82, converter(-0.05, 0.03)));
  ASSERT_NE(claimed(d), nullptr) << told(d);
  EXPECT_NE(claimed(d)->form, "bit_weights");
  EXPECT_LT(claimed(d)->error_after, 0.6 * claimed(d)->error_before);
}

// All in the same direction: most of it is another gain, and a straight line through the readings is far from what came in.
TEST(Converter, ErrorsOfATenthAreFoundTogetherWithWhatCameIn) {
  for (const double tenth : {-0.1, 0.1}) {
    const Diagnosis d = answer(make_campaign(87, converter(tenth, 0.8 * tenth, 0.4 * tenth)));
    ASSERT_NE(claimed(d), nullptr) << told(d);
    EXPECT_EQ(claimed(d)->form, "large_bit_weights");
    EXPECT_LT(claimed(d)->error_after, 0.3 * claimed(d)->error_before);
  }
}

// The codes themselves, of which nobody wrote down how many there are.
Campaign in_counts(Campaign c, double codes) {
  for (Record& r : c.records) {
    Channel& U = *r.trace.find("U");
    U.unit = "counts", U.quantity = "code";
    for (double& u : U.value) u = std::min(std::floor(u / 10.0 * codes + 1e-6), codes - 1.0);
  }
  c.bench.voltage_min_V = c.bench.voltage_max_V = kMissing;
  return c;
}

TEST(Converter, CountsNeedNoRange) {
  for (const double codes : {4096.0, 65536.0}) {
    const Diagnosis d = answer(in_counts(make_campaign(82, converter(-0.05, 0.03)), codes));
    ASSERT_NE(claimed(d), nullptr) << told(d);
    EXPECT_LT(claimed(d)->error_after, 0.6 * claimed(d)->error_before);
    EXPECT_LT(probability(d, "static_nonlinearity"), 0.5) << told(d);
  }
  EXPECT_EQ(answer(in_counts(make_campaign(90, straight), 4096.0)).verdict, DiagnosisVerdict::none);
}

TEST(Converter, ACurveIsNone) {
  const Campaign volts = make_campaign(83, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(8.0 * std::tanh(f / 6.0) + 0.2);
    return U;
  });
  for (const Campaign& c : {volts, in_counts(volts, 4096.0)}) {
    const Diagnosis d = answer(c);
    EXPECT_EQ(claimed(d), nullptr) << told(d);
    EXPECT_GT(probability(d, "static_nonlinearity"), 0.5) << told(d);
  }
}

std::vector<std::string> named(const std::vector<HealthClaim>& claims) {
  std::vector<std::string> out;
  for (const HealthClaim& claim : claims) out.push_back(claim.effect);
  return out;
}

std::vector<double>& output_of(Record& r) { return r.trace.channels[1].value; }

// Every code within 0.2 V of a half and of a quarter of the range comes out as the one below the gap.
// Curves between the carries follow a part of what a larger lag leaves, in more rows than the lag itself: they are refused for it, and the lag is asked.
TEST(Converter, BitsThatExplainLittleKeepNoLagFromBeingAsked) {
  const Sensor straight_in = converter(0.04, -0.03, 0.02);
  const Diagnosis d = answer(make_campaign(88, [&](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> late_N;
    double film = F[0];
    for (const double f : F) {
      film += (f - film) * -std::expm1(-0.005 / 0.3);
      late_N.push_back(0.45 * f + 0.55 * film);
    }
    return straight_in(t, late_N, record);
  }));
  EXPECT_GE(probability(d, "lag"), 0.5) << told(d);
  EXPECT_NE(claimed(d), nullptr) << told(d);
}

// Behind a curve that is many times as large.
TEST(Converter, BitsStandBesideACurveWhereTheOutputJumps) {
  const Sensor straight_in = converter(0.012, -0.008, 0.006);
  const Diagnosis d = answer(make_campaign(88, [&](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> bent_N;
    for (const double f : F) bent_N.push_back(1.7 * std::pow(std::max(0.0, f), 0.65));
    return straight_in(t, bent_N, record);
  }));
  EXPECT_NE(claimed(d), nullptr) << told(d);
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.5) << told(d);
}

TEST(Converter, CodesThatNeverComeAreNoLostSamplesAndNoRail) {
  Campaign c = make_campaign(84, straight);
  for (Record& r : c.records)
    for (double& u : output_of(r))
      for (const double middle : {5.0, 2.5})
        if (std::abs(u - middle) < 0.2) u = middle - 0.2;
  const std::vector<HealthClaim> claims = claims_of_samples(c);
  ASSERT_EQ(named(claims), std::vector<std::string>{"adc_codes"});
  EXPECT_EQ(claims[0].value, 2.3);
}

// Of six carries, from either side: so many values are nobody's lost samples, though a staircase jumps to them.
TEST(Converter, CodesThatStickAtEveryCarryOfThreeBitsAreNoLostSamples) {
  Campaign c = make_campaign(89, straight);
  for (Record& r : c.records)
    for (double& u : output_of(r)) {
      const double carry = 1.25 * std::round(u / 1.25);
      if (std::abs(u - carry) < 0.2 && carry > 0.0 && carry < 8.0) u = carry;
    }
  EXPECT_EQ(named(claims_of_samples(c)), std::vector<std::string>{"adc_codes"});
}

// Far more values than a converter has carries, and the highest ends the record as a rail would.
TEST(Converter, LowerBitsThatStandStillAboveALevelAreNoLostSamplesAndNoRail) {
  Campaign c = make_campaign(90, straight);
  for (Record& r : c.records)
    for (double& u : output_of(r))
      if (u > 2.0) u = 0.3 * std::floor(u / 0.3);
  EXPECT_EQ(named(claims_of_samples(c)), std::vector<std::string>{"adc_codes"});
}

TEST(Converter, WhatALinkHoldsOfACoarseConverterIsLost) {
  Campaign c = make_campaign(91, straight);
  for (Record& r : c.records) {
    std::vector<double>& U = output_of(r);
    for (double& u : U) u = 0.04 * std::round(u / 0.04);
    for (std::size_t from = 500; from + 60 < U.size(); from += 1500)
      for (std::size_t i = from; i < from + 60; ++i) U[i] = U[from];
  }
  const std::vector<std::string> effects = named(claims_of_samples(c));
  EXPECT_NE(std::ranges::find(effects, "dropouts"), effects.end());
  EXPECT_EQ(std::ranges::find(effects, "adc_codes"), effects.end());
}

TEST(Converter, ACodeThatStandsOnceInEachOfTwoRecordsIsNoLostSample) {
  Campaign c = make_campaign(88, straight);
  for (const std::size_t k : {0u, 4u})  // the slow ramps, on their first way up
    for (double& u : output_of(c.records[k])) {
      if (u > 5.25) break;
      if (u > 5.0) u = 5.0;
    }
  EXPECT_EQ(named(claims_of_samples(c)), std::vector<std::string>{"adc_codes"});
}

TEST(Converter, ALinkThatFallsToOneValueFromAnywhereLosesSamples) {
  Campaign c = make_campaign(85, straight);
  for (Record& r : c.records)
    for (std::size_t from = 500; from + 60 < output_of(r).size(); from += 2500)
      for (std::size_t i = from; i < from + 60; ++i) output_of(r)[i] = 6.0;
  EXPECT_EQ(named(claims_of_samples(c)), std::vector<std::string>{"dropouts"});
}

// Reached from below and from above, in many records, and with nothing beyond: no code is missing there.
TEST(Converter, ARailIsNoGapInTheCodes) {
  Campaign c = make_campaign(86, straight);
  for (Record& r : c.records)
    for (double& u : output_of(r)) u = std::min(u, 7.0);
  for (const std::string& effect : named(claims_of_samples(c))) EXPECT_NE(effect, "adc_codes");
}

}  // namespace
}  // namespace forcegate::diagnose
