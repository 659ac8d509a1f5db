#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// 12 bits over 10 V: the two highest weigh too much or too little, as shares of the range.
Sensor converter(double half, double quarter) {
  return [=](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) {
      const double x = 2.0 * f + 0.2;
      U.push_back(x + 10.0 * ((x >= 5.0 ? half : 0.0) + (std::fmod(x, 5.0) >= 2.5 ? quarter : 0.0)));
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
  EXPECT_EQ(claimed(d)->form, "bit_weights_of_input");
  EXPECT_LT(claimed(d)->error_after, 0.6 * claimed(d)->error_before);
}

TEST(Converter, ACurveIsNone) {
  const Diagnosis d = answer(make_campaign(83, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(8.0 * std::tanh(f / 6.0) + 0.2);
    return U;
  }));
  EXPECT_EQ(claimed(d), nullptr) << told(d);
  EXPECT_GT(probability(d, "static_nonlinearity"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
