// A model is the same model on every campaign.

#include "hil/model/model_frame.h"

#include <gtest/gtest.h>

#include "hil/model/model.h"
#include "synthetic.h"

namespace forcegate {
namespace {

Model model_of(const std::string& law, const std::string& effects) {
  const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = 0.0\n" + law + effects, "m.toml");
  EXPECT_TRUE(model) << model.error().to_text();
  return *model;
}

// A load that rises to 2.4 N and comes back, of a campaign whose forces span `range_N`.
CampaignInput to_and_fro(double range_N, double temperature_C = kMissing, double humidity_pct = kMissing, double drive_V = kMissing) {
  CampaignInput c;
  c.range_N = range_N;
  c.lowest_N = 0.1 * range_N;
  c.travel_total_N = 10.0 * range_N;
  RecordInput r;
  for (int i = 0; i < 200; ++i) {
    const double x = i / 100.0;
    r.t_s.push_back(0.02 * i);
    r.F_N.push_back(2.4 * (x < 1.0 ? x : 2.0 - x));
  }
  const std::size_t n = r.t_s.size();
  r.ok.assign(n, 1);
  r.decay.assign(n, 1.0);
  r.U_V.assign(n, 0.0);
  r.rate_N_per_s.assign(n, 0.0);
  r.travel_N = r.F_N;
  r.drive_mean_V = drive_V;
  if (std::isfinite(temperature_C)) r.temp_C.assign(n, temperature_C);
  if (std::isfinite(humidity_pct)) r.humidity.assign(n, humidity_pct);
  c.records = {r};
  return c;
}

std::vector<double> output_of(const Model& model, const CampaignInput& campaign) {
  const auto U = model_output_V(model, CampaignInFrame(model.frame, campaign), campaign.records.front());
  EXPECT_TRUE(U);
  return U.value_or(std::vector<double>());
}

const std::string kBent = "[[effect]]\nname = \"static_nonlinearity\"\nform = \"polynomial\"\nstrength.c2 = 0.2\n";
const std::string kLoop = "[[effect]]\nname = \"hysteresis\"\nform = \"play_bank\"\nstrength.w4 = 0.1\n";
const std::string kWorn = "[[effect]]\nname = \"wear\"\nform = \"linear\"\nstrength.loss = 0.2\n";

TEST(ModelFrame, TheOutputOfAModelDoesNotDependOnTheCampaignThatItIsAskedOn) {
  const Model model = model_of("span_N = 5.0\nlowest_N = 0.2\ntravel_N = 40.0\n", kBent + kLoop + kWorn);
  const std::vector<double> there = output_of(model, to_and_fro(5.0));
  EXPECT_GT(there[100], 4.9) << "2.4 N and what the curve adds";
  for (const double range_N : {2.5, 10.0}) EXPECT_EQ(output_of(model, to_and_fro(range_N)), there) << range_N;
}

TEST(ModelFrame, EffectsOfTheAirAndOfTheDriveAreZeroWhereTheModelSaysSo) {
  const Model model = model_of("temperature_C = 20.0\nhumidity_pct = 40.0\ndrive_V = 2.0\n",
                               "[[effect]]\nname = \"thermal\"\nform = \"lagged\"\nshape.tau_s = 0.0\nstrength.c_gain_per_C = 0.01\n"
                               "[[effect]]\nname = \"humidity\"\nform = \"lagged\"\nshape.tau_s = 0.0\nstrength.c_gain_per_pct = 0.001\n"
                               "[[effect]]\nname = \"bias\"\nform = \"relative\"\nstrength.c_gain = 0.1\n");
  EXPECT_NEAR(output_of(model, to_and_fro(5.0, 20.0, 40.0, 2.0))[100], 4.8, 1e-12);
  EXPECT_NEAR(output_of(model, to_and_fro(5.0, 35.0, 40.0, 2.0))[100], 4.8 * 1.15, 1e-12);
  EXPECT_NEAR(output_of(model, to_and_fro(5.0, 20.0, 60.0, 2.0))[100], 4.8 * 1.02, 1e-12);
  EXPECT_NEAR(output_of(model, to_and_fro(5.0, 20.0, 40.0, 3.0))[100], 4.8 * 1.05, 1e-12);
}

TEST(ModelFrame, AFileThatDoesNotSayTakesTheMeanOfTheCampaign) {
  const Model model = model_of("", "[[effect]]\nname = \"thermal\"\nform = \"lagged\"\nshape.tau_s = 0.0\nstrength.c_gain_per_C = 0.01\n");
  EXPECT_NEAR(output_of(model, to_and_fro(5.0, 35.0))[100], 4.8, 1e-12);
}

TEST(ModelFrame, IsThatOfTheCampaignAndSurvivesWriting) {
  const auto campaign = make_campaign_input(test::campaign([](double, double F) { return F; }));
  ASSERT_TRUE(campaign);
  Model model = *library_model("flexiforce");
  model.frame = frame_of(*campaign);
  EXPECT_NEAR(model.frame.span_N, 4.0, 0.05);
  EXPECT_NEAR(model.frame.lowest_N, 0.2, 0.05);
  EXPECT_NEAR(model.frame.temperature_C, 23.0, 2.0);
  EXPECT_TRUE(std::isnan(model.frame.humidity_pct));
  const auto again = parse_model(write_model(model), "test");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_EQ(again->frame.span_N, model.frame.span_N);
  EXPECT_EQ(again->frame.lowest_N, model.frame.lowest_N);
  EXPECT_EQ(again->frame.temperature_C, model.frame.temperature_C);
  EXPECT_EQ(again->frame.travel_N, model.frame.travel_N);
  EXPECT_TRUE(std::isnan(again->frame.humidity_pct) && std::isnan(again->frame.drive_V));
}

}  // namespace
}  // namespace forcegate
