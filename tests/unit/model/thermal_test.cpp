#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/lagged_channel.h"
#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

TEST(Thermal, ABendIsAskedWhereTheTemperatureRunsThroughDegreesWithinARecord) {
  const EffectKind* thermal = EffectRegistry::instance().find("thermal");
  ASSERT_NE(thermal, nullptr);
  const auto form = std::ranges::find(thermal->forms, "activated", &EffectForm::name);
  ASSERT_NE(form, thermal->forms.end());
  auto made = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F - 0.2; }));
  ASSERT_TRUE(made.has_value());
  CampaignInput campaign = std::move(*made);
  for (RecordInput& r : campaign.records) r.temp_C.assign(r.rows(), 20.0 + 5.0 * static_cast<double>(r.index));
  EXPECT_TRUE(form->grid(campaign).empty()) << "five degrees between records tell of no bend";
  RecordInput& warming = campaign.records.back();
  for (std::size_t i = 0; i < warming.rows(); ++i) warming.temp_C[i] += 4.0 * warming.t_s[i] / warming.t_s.back();
  EXPECT_FALSE(form->grid(campaign).empty());
  EXPECT_NEAR(bent(0.03, 10.0), (std::exp(0.3) - 1.0) / 0.03, 1e-12);
  EXPECT_EQ(bent(0.0, 10.0), 10.0);
}

}  // namespace
}  // namespace forcegate
