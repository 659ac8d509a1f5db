// What a verb says of a recording whose columns it cannot place: which file, which line, and a command that can be pasted.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hil/app/model/model_input.h"
#include "hil/model/rows.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

class CampaignColumns : public FolderTest {
 protected:
  CampaignRequest put(const std::string& text) {
    CampaignRequest request;
    request.campaign = FolderTest::put("run.csv", text);
    return request;
  }
};

TEST_F(CampaignColumns, TheHintForAWeightInGramsCanBePastedAndTheHeadersLineIsNamed) {
  const auto campaign = load_campaign(put("# bench 2\nt_s,Cell (g),U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().where, EndsWith("run.csv:2"));
  EXPECT_THAT(campaign.error().hint, HasSubstr("--map 'Cell_(g)=F_ref_gf'"));
  const auto two = load_campaign(put("t_s,Cell A (N),Cell B (N),U_V\n0,1,2,3\n1,2,3,4\n"));
  ASSERT_FALSE(two);
  EXPECT_THAT(two.error().where, EndsWith("run.csv:1"));
}

TEST_F(CampaignColumns, TheHintForAColumnThatIsCalledByItsUnitKeepsTheUnit) {
  const auto kilograms = load_campaign(put("t_s,kgf,U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_FALSE(kilograms);
  EXPECT_THAT(kilograms.error().hint, HasSubstr("--map kgf=F_ref_kgf"));
  const auto grams = load_campaign(put("t_s,g,U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_FALSE(grams);
  EXPECT_THAT(grams.error().hint, HasSubstr("--map g=F_ref_gf"));
}

TEST_F(CampaignColumns, AMapIsSplitAtItsLastEqualsSignAndOneWithoutANameIsRefused) {
  CampaignRequest request = put("t_s,cell at x=3,U_V\n0,1,2\n1,2,3\n2,3,4\n");
  request.maps = {"cell_at_x=3=F_ref_N"};
  const auto campaign = load_campaign(request);
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  request.maps = {"cell_at_x="};
  const auto refused = load_campaign(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_THAT(refused.error().to_text(), HasSubstr("cell_at_x="));
}

TEST_F(CampaignColumns, AColumnThatWasLeftOutForItsTextIsNamedWhereItIsMissed) {
  const auto campaign = load_campaign(put("t_s,F_ref_N,R (kOhm)\n0,1,OL\n1,2,OL\n2,3,40\n"));
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().text, HasSubstr("\"R (kOhm)\" holds text and was left out: \"OL\" in line 2 is a meter over its range"));
  EXPECT_THAT(campaign.error().hint, HasSubstr("empty the cells"));
  const auto state = load_campaign(put("t_s,F_ref_N,R\n0,1,idle\n1,2,idle\n2,3,idle\n"));
  ASSERT_FALSE(state);
  EXPECT_THAT(state.error().text, EndsWith("; column \"R\" holds text and was left out"));
}

TEST_F(CampaignColumns, TheHintForCodesAndRatiosIsWhatTheyAre) {
  for (const auto& [name, map] : {std::pair{"ADC code", "--map 'ADC code=U_counts' where it holds codes"}, {"Lectura ADC", "--map 'Lectura ADC=U_counts'"}, {"raw", "--map raw=U_counts"},
                                  {"Vout/Vcc", "--map Vout/Vcc=U_V where it is a ratio"}, {"Encoder", "--map NAME=U_V"}}) {
    const auto campaign = load_campaign(put(std::string("t_s,F_ref_N,") + name + "\n0,1,17\n1,2,18\n2,3,19\n"));
    ASSERT_FALSE(campaign) << name;
    EXPECT_THAT(campaign.error().hint, HasSubstr(map)) << name;
  }
}

TEST_F(CampaignColumns, WhereNoColumnIsLeftNobodyIsToNameOne) {
  for (const char* text : {"time_s,force_N\n0,1\n1,2\n2,3\n", "time_s,voltage_V,temp_C\n0,1,20\n1,2,20\n2,3,20\n"}) {
    const auto campaign = load_campaign(put(text));
    ASSERT_FALSE(campaign) << text;
    EXPECT_THAT(campaign.error().hint, AllOf(HasSubstr("no column left for it: force and output must stand in one table on one clock"), Not(HasSubstr("NAME"))));
  }
  const auto one = load_campaign(put("t_s,F_ref_N,Encoder,temp_C\n0,1,17,20\n1,2,18,20\n2,3,19,20\n"));
  ASSERT_FALSE(one);
  EXPECT_THAT(one.error().hint, HasSubstr("--map NAME=U_V, where \"Encoder\" is the only column left"));
}

TEST_F(CampaignColumns, TwoLoggersInOneTableAreReadAtTheSlowerOne) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.01 * i;
    text += fmt::format("{:.4f},,{:.5f}\n", t, 0.5 * (2.0 + std::sin(3.0 * t)));
    if (i % 2 == 0) text += fmt::format("{:.4f},{:.5f},\n", t + 0.003, 2.0 + std::sin(3.0 * (t + 0.003)));
  }
  const auto campaign = load_campaign(put(text));
  ASSERT_TRUE(campaign) << campaign.error().to_text();
  const Trace& trace = campaign->records.front().trace;
  const std::vector<double>&F = trace.find("F_ref")->value, &U = trace.find("U")->value;
  EXPECT_NEAR(static_cast<double>(trace.size()), 2000.0, 2.0);
  for (std::size_t i = 1; i + 1 < F.size(); ++i) EXPECT_NEAR(U[i], 0.5 * F[i], 1e-3);
}

TEST_F(CampaignColumns, AForceOrAnOutputWithoutANumberIsAnErrorAndNoForceThatStandsStill) {
  for (const auto& [header, name] : {std::pair{"t_s,Kraft (N),U_V\n", "Kraft (N)"}, std::pair{"t_s,U_V,F_ref_N\n", "U_V"}}) {
    std::string text = header;
    for (int i = 0; i < 40; ++i) text += std::to_string(i) + (i % 2 == 0 ? ",NaN,0.5\n" : ",,0.6\n");
    const auto campaign = load_recordings(put(text));
    ASSERT_FALSE(campaign) << header;
    EXPECT_THAT(campaign.error().text, HasSubstr("column \"" + std::string(name) + "\" holds no number in any of 40 rows"));
    EXPECT_THAT(campaign.error().where, EndsWith("run.csv:1"));
    EXPECT_THAT(campaign.error().hint, HasSubstr("names another column"));
  }
}

TEST_F(CampaignColumns, NumbersBeyondWhatIsReadAreToldAsThatAndNotAsNone) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 40; ++i) text += std::to_string(i) + ",1e200,0.5\n";
  const auto campaign = load_recordings(put(text));
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().text, HasSubstr("column \"F_ref_N\" holds no number below 9.9e37 in any of 40 rows, and it is the force"));
  EXPECT_THAT(campaign.error().to_text(), AllOf(HasSubstr("an instrument's overload"), Not(HasSubstr("is the instrument connected"))));
}

TEST_F(CampaignColumns, DaysThatWereTakenForSecondsAreToldWhereTheRecordIsTooShort) {
  for (const double first : {46347.4, 0.4}) {
    std::string text = "Time,F_ref_N,U_V\n";
    for (int i = 0; i < 200; ++i) text += std::to_string(first + 0.000001 * i) + "," + std::to_string(i % 9) + ",1\n";
    const CampaignRequest request = put(text);
    const auto campaign = load_campaign(request);
    ASSERT_TRUE(campaign) << campaign.error().to_text();
    auto rows = make_campaign_input(*campaign, 1);
    ASSERT_FALSE(rows);
    EXPECT_THAT(PlacesOf(*campaign, request.campaign).with_file(rows.error()).hint, HasSubstr("if it counts days, as a spreadsheet does: --map Time=t_days")) << first;
  }
}

TEST_F(CampaignColumns, ARecordThatIsTooShortIsNamedByItsFile) {
  const auto campaign = load_campaign(put("t_s,F_ref_N,U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_TRUE(campaign);
  const auto rows = make_campaign_input(*campaign, 1);
  ASSERT_FALSE(rows);
  EXPECT_THAT(rows.error().where, EndsWith("run.csv"));
}

}  // namespace
}  // namespace forcegate
