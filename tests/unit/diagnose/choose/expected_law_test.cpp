// The curve that every sensor of a shipped law has and its model lacks.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

Diagnosis answer_of(const Sensor& sensor) {
  const auto fsr = library_model("fsr");
  EXPECT_TRUE(fsr);
  EngineOptions options = options_of(*fsr);
  options.model_name = "fsr";
  auto out = diagnose_campaign(make_campaign(7, sensor), options);
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

double probability_of(const Diagnosis& d, const std::string& effect) {
  const auto f = std::ranges::find(d.findings, effect, &Finding::effect);
  return f == d.findings.end() ? 0.0 : f->probability;
}

// Over a sensor's range a power just above 1 is a straight line that begins late.
TEST(ExpectedLaw, AnFsrThatIsNearlyStraightHasACurveAndNoThreshold) {
  const Diagnosis d = answer_of([](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) {
      const double G = std::pow(std::max(f, 0.0) / 4.6, 1.05);
      U.push_back(0.2 + 8.3 * G / (1.0 + 0.037 * G));
    }
    return U;
  });
  EXPECT_LT(probability_of(d, "dead_zone"), 0.2);
  EXPECT_GT(probability_of(d, "static_nonlinearity"), 0.8);
}

TEST(ExpectedLaw, AThresholdBesideTheCurveIsAThresholdStill) {
  const Diagnosis d = answer_of([](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(0.2 + 8.0 * std::pow(std::max(f - 1.4, 0.0) / 4.6, 0.8));
    return U;
  });
  EXPECT_GT(probability_of(d, "dead_zone"), 0.5);
}

}  // namespace
}  // namespace forcegate::diagnose
