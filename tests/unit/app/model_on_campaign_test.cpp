// What the verbs that ask a model do with a campaign other than the one it was fitted on, and with samples that are none of the sensor's.

#include <gmock/gmock.h>
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
#include "hil/app/model/history.h"
#include "hil/app/model/simulate.h"
#include "hil/base/rng.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

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

  // A sine of 1 to 3 N times `factor`, beside `gain` of the output for each newton.
  CampaignRequest one_recording(const std::string& name, const std::string& header, double factor, double gain) {
    std::string text = header;
    for (int i = 0; i < 3000; ++i) {
      const double F_N = 2.0 + std::sin(0.02 * i);
      text += std::to_string(0.01 * i) + "," + std::to_string(factor * F_N) + "," + std::to_string(std::round(100.0 * gain * F_N) / (gain > 100.0 ? 1.0 : 100.0)) + "\n";
    }
    CampaignRequest out;
    out.campaign = put(name, text);
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

TEST_F(ModelOnCampaign, OfRecordsInAnotherUnitItsOwnNumbersSayNothing) {
  CampaignRequest request = one_recording("counts.csv", "t_s,F_ref_N,adc\n", 1.0, 200.0);
  const auto c = compare_request(request);
  ASSERT_TRUE(c) << c.error().to_text();
  ASSERT_EQ(c->as_written.size(), 1u);
  EXPECT_TRUE(std::isnan(c->as_written.front().rmse_V));
  EXPECT_NE(comparison_json(*c).find("\"rmse_V\": null"), std::string::npos);
  EXPECT_EQ(comparison_text(*c).find("as written, the whole recording"), std::string::npos);
  EXPECT_EQ(std::ranges::count_if(c->view.notes, [](const std::string& n) { return n.find("the model takes an output in V, and these records hold it in counts") != std::string::npos; }), 1);
}

TEST_F(ModelOnCampaign, AForceThatMovesTheModelAThousandTimesTooFarMayBeInAnotherUnit) {
  const auto told = [&](const char* header, double factor) {
    const auto c = compare_request(one_recording("force.csv", header, factor, 2.0));
    EXPECT_TRUE(c) << (c ? "" : c.error().to_text());
    for (const std::string& n : c->view.notes)
      if (n.starts_with("the model as written moves its output ")) return n.substr(n.find("--map"));
    return std::string();
  };
  EXPECT_EQ(told("t_s,F_ref_N,U_V\n", 1.0), "");
  EXPECT_EQ(told("t_s,F_ref_kN,U_V\n", 1e-3), "");
  EXPECT_EQ(told("t_s,F_ref_N,U_V\n", 100.0), "") << "sensors of one kind differ that far";
  EXPECT_EQ(told("t_s,F_ref_kN,U_V\n", 1.0), "--map F_ref_kN=F_ref_N:1 reads 1 N for each 1 in that column");
  EXPECT_EQ(told("t_s,F_ref_N,U_V\n", 1000.0), "--map F_ref_N=F_ref_N:0.001 reads 0.001 N for each 1 in that column");
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

// Ramps of 4 N, then sines of 1.2 N: where the frequency changes as well the fall of the force was taken for that of the film.
TEST_F(ModelOnCampaign, ASwingOfTheForceThatBecomesSmallerIsNoDecay) {
  std::string text = "t_s,F_ref_N,U_V\n";
  Rng rng(4, "falling swing");
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.01 * i, ramp = 2.0 + 4.0 * (std::abs(std::fmod(t / 20.0, 2.0) - 1.0) - 0.5), F = t < 100.0 ? ramp : 2.0 + 0.6 * std::sin(2.0 * std::numbers::pi * 0.5 * t);
    text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(0.2 + 2.0 * F + 0.002 * rng.normal()) + "\n";
  }
  CampaignRequest request;
  request.campaign = put("falls.csv", text);
  request.threads = 1;
  request.model = put("decays.toml", "[law]\ngain_N_per_V = 0.5\noffset_N = -0.1\n").string();
  const auto compared = compare_request(request);
  ASSERT_TRUE(compared) << compared.error().to_text();
  EXPECT_LT(compared->as_written.at(0).rmse_V, 0.01);
  const auto simulated = simulate_request(request, folder_ / "out");
  ASSERT_TRUE(simulated) << simulated.error().to_text();
  EXPECT_LT(simulated->items.at(0).rmse_V.value_or(9.0), 0.01);
}

TEST_F(ModelOnCampaign, OfOneShortRecordingNoLawIsLeftToRefitAndNothingRepeatsItself) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 199; ++i) {
    const double F = 2.0 + 1.5 * std::sin(0.1 * i);
    text += std::to_string(2.0 * i) + "," + std::to_string(F) + "," + std::to_string(0.2 + 2.0 * F + (i % 2 == 0 ? 0.003 : -0.003)) + "\n";
  }
  CampaignRequest request;
  request.campaign = put("short.csv", text);
  request.threads = 1;
  request.model = put("exact.toml", "[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = -0.1\n").string();
  const auto compared = compare_request(request);
  ASSERT_TRUE(compared) << compared.error().to_text();
  ASSERT_TRUE(compared->too_short);
  const std::string said = comparison_text(*compared);
  EXPECT_NE(said.find("            -"), std::string::npos) << said;
  EXPECT_EQ(said.find("repeatability"), std::string::npos) << said;
  EXPECT_NE(comparison_json(*compared).find("\"plain_before\": null"), std::string::npos) << comparison_json(*compared);
}

TEST_F(ModelOnCampaign, AFitSaysThatTheFileIsOfAnotherOutput) {
  CampaignRequest request = campaign("film", {20.0, 20.0, 20.0});
  request.model = put("counts.toml", "output_unit = \"counts\"\n[law]\ngain_N_per_V = 0.002\n").string();
  const auto fitted = fit_request(request, "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_EQ(fitted->model.output_unit, "V");
  EXPECT_THAT(fitted->notes, Contains(HasSubstr("the model takes an output in counts, and these records hold it in V")));
}

TEST_F(ModelOnCampaign, AFitSaysThatTheDecayOfTheModelIsGone) {
  CampaignRequest request = one_recording("still.csv", "t_s,F_ref_N,U_V\n", 1.0, 2.0);
  const auto fitted = fit_request(request, "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_FALSE(fitted->model.law.decays);
  EXPECT_THAT(fitted->notes, Contains(HasSubstr("what is fitted is kind = \"static\"")));
  request.model = put("static.toml", "[law]\nkind = \"static\"\n").string();
  const auto again = fit_request(request, "");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_THAT(again->notes, Not(Contains(HasSubstr("kind = \"static\""))));
}

// A step that was taken from a model that no file keeps is not that step when it is taken again.
TEST_F(ModelOnCampaign, HistorySaysWhereAStepIsNotAsItWas) {
  CampaignRequest request = campaign("film", {20.0, 22.0, 27.0, 24.0, 21.0, 29.0});
  const auto added = fit_request(request, "thermal");
  ASSERT_TRUE(added) << added.error().to_text();
  Model model = added->model;
  const auto notes = [&] {
    request.model = put("better.toml", write_model(model)).string();
    const auto history = history_request(request);
    EXPECT_TRUE(history) << history.error().to_text();
    return history ? history->notes : std::vector<std::string>{};
  };
  EXPECT_THAT(notes(), Not(Contains(HasSubstr("taken again"))));
  model.history.back().error_before *= 0.7;
  EXPECT_THAT(notes(), Contains(HasSubstr("taken again, thermal is ")));
  model.history.back().campaign = "another";
  EXPECT_THAT(notes(), Not(Contains(HasSubstr("taken again"))));
}

TEST_F(ModelOnCampaign, CompareSaysByWhichLawARecordIsPredicted) {
  const auto c = compare_request(campaign("film", {20.0, 20.0, 20.0}));
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_THAT(comparison_text(*c), HasSubstr("refitted: each record by one law for all the others.\n"));
}

}  // namespace
}  // namespace forcegate
