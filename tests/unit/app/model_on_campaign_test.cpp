// What the verbs that ask a model do with a campaign other than the one it was fitted on, and with samples that are none of the sensor's.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/export/export.h"
#include "hil/app/model/compare.h"
#include "hil/app/model/fit.h"
#include "hil/app/model/simulate.h"
#include "hil/base/rng.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

class ModelOnCampaign : public FolderTest {
 protected:
  // Three static records at these temperatures of a sensor of 2 V/N (1 + 0.01 (T - 20)).
  CampaignRequest campaign(const std::string& name, std::initializer_list<double> temperatures_C, bool spikes = false) {
    std::string records;
    int k = 0;
    Rng rng(9, name);
    for (const double T : temperatures_C) {
      const std::string file = "r" + std::to_string(k) + ".csv";
      std::string csv = "t_s,F_ref_N,U_V\n";
      for (int i = 0; i < 6000; ++i) {
        const double t = 0.01 * i, F = 2.0 + 1.5 * std::sin(2.0 * std::numbers::pi * t / (20.0 + k)), bad = spikes && i % 271 == 135 ? 9.0 : 0.0;
        const double U = bad > 0.0 ? bad : 0.2 + 2.0 * F * (1.0 + 0.01 * (T - 20.0)) + 0.002 * rng.normal();
        csv += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(U) + "\n";
      }
      put(name + "/" + file, csv);
      records += (k > 0 ? ", " : "") + std::string("{\"file\": \"") + file + "\", \"kind\": \"ramp\", \"start_s\": " + std::to_string(600 * k) +
                 ", \"temp_C\": " + std::to_string(T) + "}";
      ++k;
    }
    put(name + "/campaign.json", "{\"records\": [" + records + "]}");
    CampaignRequest out;
    out.campaign = folder_ / name;
    out.threads = 1;
    return out;
  }

  std::string warm_model(const std::string& frame) {
    return put("model.toml", "[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = -0.1\n" + frame +
                                 "[[effect]]\nname = \"thermal\"\nform = \"lagged\"\nshape.tau_s = 0.0\nstrength.c_gain_per_C = 0.01\n")
        .string();
  }

};

TEST_F(ModelOnCampaign, AsWrittenItMeansOnAWarmDayWhatItMeantWhereItWasFitted) {
  for (const auto& [name, T] : {std::pair{"cold", 20.0}, std::pair{"hot", 35.0}}) {
    CampaignRequest request = campaign(name, {T, T, T});
    request.model = warm_model("span_N = 3.0\ntemperature_C = 20.0\n");
    const auto c = compare_request(request);
    ASSERT_TRUE(c) << c.error().to_text();
    ASSERT_EQ(c->as_written.size(), 3u);
    for (const auto& record : c->as_written) EXPECT_LT(record.rmse_V, 0.003) << name;
    const auto s = simulate_request(request, folder_ / "out");
    ASSERT_TRUE(s) << s.error().to_text();
    for (const auto& record : s->items) EXPECT_LT(record.rmse_V, 0.003) << name;
  }
}

TEST_F(ModelOnCampaign, SamplesThatADiagnosisThrowsOutAreNoErrorOfTheModel) {
  CampaignRequest request = campaign("spikes", {20.0, 20.0, 20.0}, true);
  request.model = warm_model("temperature_C = 20.0\n");
  const auto c = compare_request(request);
  ASSERT_TRUE(c) << c.error().to_text();
  for (const auto& record : c->as_written) EXPECT_LT(record.rmse_V, 0.003);
  const auto s = simulate_request(request, folder_ / "out");
  ASSERT_TRUE(s) << s.error().to_text();
  for (const auto& record : s->items) EXPECT_LT(record.rmse_V, 0.003);
}

// A line of 2 V/N bent by 3 %, and one sample that is none of the sensor's.
TEST_F(ModelOnCampaign, SamplesTooFewForAClaimAreInNoVerbsError) {
  for (const double bad : {15.0, -9999.0, 9.9e37}) {
    Rng rng(6, "bent");
    std::string csv = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < 9000; ++i) {
      const double F = 2.0 - 1.5 * std::cos(0.02 * i / 3.0) - 0.3 * std::cos(0.02 * i);
      csv += std::to_string(0.02 * i) + "," + std::to_string(F) + "," + std::to_string(i == 8000 ? bad : 0.2 + 2.0 * F - 0.02 * F * F + 0.003 * rng.normal()) + "\n";
    }
    CampaignRequest request;
    request.campaign = put("bent.csv", csv);
    request.threads = 1;
    const auto c = compare_request(request);
    const auto d = diagnose_request(request);
    const auto added = fit_request(request, "static_nonlinearity");
    ASSERT_TRUE(c && d && added);
    EXPECT_LT(c->view.error_before, 0.1) << bad;
    EXPECT_NEAR(d->error_before, added->error_before, 0.05 * added->error_before) << bad;
    EXPECT_LT(d->error_after, 0.2 * d->error_before) << bad;
  }
}

TEST_F(ModelOnCampaign, AHoldHasNoLawToFit) {
  Rng rng(4, "hold");
  std::string csv = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 2000; ++i)
    csv += std::to_string(0.01 * i) + "," + std::to_string(2.0 + 0.004 * rng.normal()) + "," + std::to_string(4.1 + 0.004 * rng.normal()) + "\n";
  CampaignRequest request;
  request.campaign = put("hold.csv", csv);
  const auto fitted = fit_request(request, "");
  ASSERT_FALSE(fitted.has_value());
  EXPECT_NE(fitted.error().to_text().find("noise of its reference"), std::string::npos) << fitted.error().to_text();
  EXPECT_NE(fitted.error().to_text().find("record a force that moves"), std::string::npos) << fitted.error().to_text();
  EXPECT_FALSE(fit_request(request, "creep").has_value());
  const auto c = compare_request(request);  // it compares all the same, and says what that is worth
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_TRUE(std::ranges::any_of(c->view.notes, [](const std::string& note) { return note.find("nothing of the law between force and output") != std::string::npos; }));
}

TEST_F(ModelOnCampaign, AHeaderIsZeroWhereItsModelWasFittedAndNotWhereItIsChecked) {
  ExportRequest request;
  request.model = warm_model("");
  request.plan = "none";
  EXPECT_FALSE(export_model(request)) << "nobody says where the effect is zero";
  request.check = campaign("hot", {33.0, 35.0, 37.0});
  EXPECT_FALSE(export_model(request)) << "nor does the campaign that it is checked on";
  // one reading of the air in each record, no column
  request.fit = campaign("mild", {18.0, 21.0, 24.0, 21.0});
  request.fitted = folder_ / "fitted.toml";
  const auto fitted = export_model(request);
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_NE(fitted->compensator.header.find("from 21 degC"), std::string::npos);
  EXPECT_LT(fitted->check->compensated_rms_N, 0.01);
  ExportRequest again;
  again.model = request.fitted.string();
  again.plan = "none";
  const auto from_file = export_model(again);
  ASSERT_TRUE(from_file) << from_file.error().to_text();
  EXPECT_NE(from_file->compensator.header.find("from 21 degC"), std::string::npos);
  again.reference_temperature_C = 30.0;
  const auto other = export_model(again);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::usage);
  EXPECT_NE(other.error().text.find("zero at 21 degC"), std::string::npos) << other.error().to_text();
}

}  // namespace
}  // namespace forcegate
