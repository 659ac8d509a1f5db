// Every law of drift: what is fitted, what is drawn and what is told are one.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/app/pictures/record_pictures.h"
#include "hil/diagnose/laws/drift.h"

namespace forcegate {
namespace {

// One recording of 200 s without an input, 10 samples a second, `scatter_V` to either side in turn.
Campaign hold(const std::function<double(double t_s)>& course, double scatter_V) {
  Record record;
  record.name = "hold";
  record.trace.time_bases.emplace_back();
  Channel U;
  U.name = "U";
  U.unit = "V";
  for (int i = 0; i < 2000; ++i) {
    record.trace.time_bases[0].t_s.push_back(0.1 * i);
    U.value.push_back(course(0.1 * i) + (i % 2 == 0 ? scatter_V : -scatter_V));
  }
  record.trace.channels.push_back(U);
  Campaign campaign;
  campaign.records.push_back(record);
  return campaign;
}

class EveryLaw : public testing::TestWithParam<diagnose::DriftLaw> {
 protected:
  // A shape that is well within its bounds in a record of 200 s, one that sets in at once.
  diagnose::DriftFit truth() const {
    diagnose::DriftFit fit;
    fit.law = &law();
    fit.constant = 1.0, fit.size = law().per == std::string("/s") ? 0.002 : 0.4;
    fit.shape = law().shape_low == nullptr ? 1.0 : std::sqrt(law().shape_low(200.0) * law().shape_high(200.0));
    return fit;
  }
  const diagnose::DriftLaw& law() const {
    return *std::ranges::find(diagnose::drift_laws(), GetParam().name, &diagnose::DriftLaw::name);
  }
};
INSTANTIATE_TEST_SUITE_P(Laws, EveryLaw, testing::ValuesIn(diagnose::drift_laws()),
                         [](const auto& law) { return std::string(law.param.name); });

TEST_P(EveryLaw, ThePrimitiveIsTheIntegralOfTheCourse) {
  constexpr int kSteps = 20000;
  const double shape = truth().shape;
  for (const double from : {0.5, 20.0}) {
    const double h = 60.0 / kSteps;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) sum += h * law().course(from + (i + 0.5) * h, shape);
    EXPECT_NEAR(law().primitive(from + 60.0, shape) - law().primitive(from, shape), sum, 1e-6 * std::max(1.0, std::abs(sum)));
  }
}

TEST_P(EveryLaw, IsDrawnAsItWasFitted) {
  const Campaign campaign = hold([&](double t_s) { return diagnose::value_at(truth(), t_s); }, 1e-5);
  const RecordPictures p = drift_pictures(campaign, std::string(law().name));
  ASSERT_EQ(p.drift.size(), 1U);
  EXPECT_EQ(p.drift[0].form, law().name);
  for (std::size_t i = 1; i < p.drift[0].t_s.size(); ++i) EXPECT_NEAR(p.drift[0].modelled[i], p.drift[0].measured[i], 0.005) << i;
}

TEST_P(EveryLaw, IsToldWithItsNumbers) {
  const std::string told = law().sentence(truth(), " from 3 s on", "V");
  EXPECT_TRUE(told.starts_with("the output ")) << told;
  if (&law() == &diagnose::drift_laws().front()) return;
  EXPECT_NE(told.find(" from 3 s on"), std::string::npos) << told;
  EXPECT_EQ(law().shape_low == nullptr, law().shape_name == nullptr);
}

TEST(DriftPictures, DriftWithoutAnInputIsDrawnWithItsLaw) {
  const RecordPictures p = drift_pictures(hold([](double t_s) { return 1.0 + 0.002 * t_s; }, 1e-4), "line");
  ASSERT_EQ(p.drift.size(), 1u);
  EXPECT_EQ(p.drift[0].form, "line");
  EXPECT_NEAR(p.drift[0].modelled.back(), 1.4, 0.003);
}

}  // namespace
}  // namespace forcegate
