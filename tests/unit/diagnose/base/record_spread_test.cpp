#include "hil/diagnose/base/record_spread.h"

#include <gmock/gmock.h>

#include <numbers>

#include "hil/diagnose/refit/refit.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// Ramps of a straight sensor, 2 V/N, each with the gain that is given.
Campaign of_gains(const std::vector<double>& gains) {
  Campaign c;
  c.name = "made";
  Rng rng(3, "ramps");
  for (std::size_t k = 0; k < gains.size(); ++k) {
    Record r;
    r.name = "r" + std::to_string(k);
    r.dynamic = false;
    TimeBase clock;
    std::vector<double> F, U;
    for (int i = 0; i < 3000; ++i) {
      const double t = i / 50.0, force = 1.5 - std::cos(2.0 * std::numbers::pi * t / 30.0);
      clock.t_s.push_back(t);
      F.push_back(force + 0.001 * rng.normal());
      U.push_back(2.0 * gains[k] * force + 0.2 + 0.002 * rng.normal());
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

Refit refitted(const std::vector<double>& gains) {
  EngineOptions options;
  options.threads = 1;
  const auto model = library_model("flexiforce");
  EXPECT_TRUE(model);
  auto out = refit_campaign(of_gains(gains), options, *model, "");
  EXPECT_TRUE(out) << (out ? "" : out.error().to_text());
  return out ? *std::move(out) : Refit{};
}

TEST(RecordSpread, OfFewRecordsIsThatOfASample) {
  EXPECT_DOUBLE_EQ(of_few_records(2), std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(of_few_records(1), 1.0);
  const Diagnosis d = answer(of_gains({0.97, 1.01, 0.99, 1.03}));
  EXPECT_NEAR(d.repeatability.gain, 0.0258, 0.15 * 0.0258) << "the standard deviation of the four";
}

TEST(RecordSpread, OfADecayThatNoRecordHasIsNotKnown) {
  const Diagnosis d = answer(of_gains({0.97, 1.01, 0.99}));
  EXPECT_TRUE(std::isnan(d.repeatability.log_b));
  EXPECT_TRUE(std::isnan(d.repeatability.log_q));
}

TEST(RecordSpread, TheUncertaintyOfTheGainIsThatOfTheMeanOfThem) {
  const Refit four = refitted({0.97, 1.01, 0.99, 1.03}), two = refitted({0.98, 1.02});
  EXPECT_NEAR(four.model.se_gain / four.model.law.gain_N_per_V, 0.0129, 0.2 * 0.0129);
  EXPECT_NEAR(two.model.se_gain / two.model.law.gain_N_per_V, 0.02, 0.2 * 0.02);
  EXPECT_THAT(two.notes, Contains(HasSubstr("rest on 2 records, and what scatters between so few is known to 71 %")));
  EXPECT_THAT(four.notes, ::testing::Not(Contains(HasSubstr("between so few"))));
}

}  // namespace
}  // namespace forcegate::diagnose
