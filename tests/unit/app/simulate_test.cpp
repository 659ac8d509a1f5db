#include "hil/app/model/simulate.h"

#include <cmath>

#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

class Simulate : public FolderTest {};

TEST_F(Simulate, AnInterruptedRunLeavesNothingNew) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 1000; ++i) text += std::to_string(0.02 * i) + "," + std::to_string(1 + i % 50 * 0.05) + "," + std::to_string(2 + i % 50 * 0.1) + "\n";
  CampaignRequest request;
  request.campaign = put("film.csv", text);
  const std::filesystem::path out = folder_ / "out";
  const std::atomic<bool> interrupted{true};
  const auto stopped = simulate_request(request, out, &interrupted);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::cancelled);
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto whole = simulate_request(request, out);
  ASSERT_TRUE(whole) << whole.error().to_text();
  EXPECT_TRUE(std::filesystem::exists(out / "film.csv"));
  EXPECT_FALSE(simulate_request(request, out, &interrupted));
  EXPECT_TRUE(std::filesystem::exists(out / "film.csv")) << "what was there before stays";
}

std::string first_line(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

TEST_F(Simulate, TheHeadersNameTheUnitsAndReadBackTheSame) {
  struct Case {
    const char *name, *unit, *header;
    double scale;
  };
  for (const Case& c : {Case{"adc", "counts", "t_s,F_ref_N,U_counts,U_model_counts", 100.0}, Case{"G_uS", "S", "t_s,F_ref_N,U_S,U_model_S", 10.0},
                        Case{"U_pct", "1", "t_s,F_ref_N,U_pct,U_model_pct", 10.0}}) {
    std::string text = "t_s,F_ref_N," + std::string(c.name) + "\n";
    for (int i = 0; i < 200; ++i) text += std::to_string(0.02 * i) + "," + std::to_string(1 + i % 50 * 0.05) + "," + std::to_string(std::round(c.scale * (2 + i % 50 * 0.1))) + "\n";
    CampaignRequest request;
    request.campaign = put(std::string(c.name) + ".csv", text);
    request.model = put("m.toml", "output_unit = \"" + std::string(c.unit) + "\"\n[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = 0.0\n").string();
    const auto done = simulate_request(request, folder_ / "out");
    ASSERT_TRUE(done) << done.error().to_text();
    EXPECT_EQ(first_line(done->items[0].file), c.header);
    ASSERT_TRUE(done->items[0].rmse_V);
    request.campaign = done->items[0].file;
    const auto again = simulate_request(request, folder_ / "again");
    ASSERT_TRUE(again) << again.error().to_text();
    EXPECT_EQ(again->unit, c.unit);
    EXPECT_NEAR(*again->items[0].rmse_V, *done->items[0].rmse_V, 1e-4 * *done->items[0].rmse_V) << c.name;
  }
}

TEST_F(Simulate, AModelInVoltsIsNotComparedWithCounts) {
  std::string text = "t_s,F_ref_N,adc\n";
  for (int i = 0; i < 200; ++i) text += std::to_string(0.02 * i) + "," + std::to_string(1 + i % 50 * 0.05) + "," + std::to_string(200 + i % 50 * 10) + "\n";
  CampaignRequest request;
  request.campaign = put("counts.csv", text);
  request.model = put("m.toml", "[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = 0.0\n").string();
  const auto done = simulate_request(request, folder_ / "out");
  ASSERT_TRUE(done) << done.error().to_text();
  EXPECT_EQ(first_line(done->items[0].file), "t_s,F_ref_N,U_counts,U_model_V");
  EXPECT_FALSE(done->items[0].rmse_V);
  EXPECT_EQ(simulation_text(*done).find("RMS"), std::string::npos);
  ASSERT_FALSE(done->notes.empty());
  EXPECT_NE(done->notes.back().find("the model gives an output in V, and these records hold it in counts"), std::string::npos) << done->notes.back();
}

TEST_F(Simulate, AModelThatRunsAwayIsNamed) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 20000; ++i) text += std::to_string(0.02 * i) + "," + std::to_string(1 + i % 50 * 0.05) + "," + std::to_string(2 + i % 50 * 0.1) + "\n";
  CampaignRequest request;
  request.campaign = put("film.csv", text);
  request.model = put("m.toml",
                      "format = 1\nname = \"x\"\n[law]\nkind = \"static\"\ngain_N_per_V = 0.5\n[[effect]]\nname = \"mine\"\noutput = \"k * x\"\n"
                      "parameter.k = 0.05\nparameter.tau = -1\nstate.x = \"(F - x) / tau\"\n").string();
  const auto made = simulate_request(request, folder_ / "out");
  ASSERT_TRUE(made) << made.error().to_text();
  ASSERT_EQ(made->notes.size(), 1u);
  EXPECT_NE(made->notes.front().find("film: the model is at "), std::string::npos) << made->notes.front();
  EXPECT_NE(made->notes.front().find("may run away"), std::string::npos) << made->notes.front();
  EXPECT_EQ(simulation_text(*made).find("inf"), std::string::npos) << simulation_text(*made);
}

TEST_F(Simulate, AMapThatTakesTheOutputAwayIsNamed) {
  CampaignRequest request;
  request.campaign = put("film.csv", "t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,3\n0.2,1,2\n");
  request.maps = {"U_V=F_ref_N"};
  const auto campaign = load_campaign(request);
  ASSERT_FALSE(campaign);
  EXPECT_NE(campaign.error().hint.find("--map U_V=F_ref_N made another thing of it"), std::string::npos) << campaign.error().to_text();
  EXPECT_EQ(campaign.error().text.find("F_ref_N_N"), std::string::npos) << campaign.error().to_text();
  EXPECT_NE(campaign.error().text.find("there are F_ref_N, U_V"), std::string::npos) << "as the file writes them: " << campaign.error().text;
}

TEST_F(Simulate, AMapOntoANameThatMeansNothingIsNamed) {
  CampaignRequest request;
  request.campaign = put("film.csv", "t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,3\n0.2,1,2\n");
  for (const auto& [map, told] : {std::pair{"U_V=U_foo", "\"U_foo\" of --map U_V=U_foo is no name that means anything here: the output is U_V"},
                                  {"F_ref_N=kraftmesser1", "the force is F_ref_N"}}) {
    request.maps = {map};
    const auto campaign = load_campaign(request);
    ASSERT_FALSE(campaign) << map;
    EXPECT_NE(campaign.error().hint.find(told), std::string::npos) << campaign.error().to_text();
  }
  request.maps = {"U_V=unused"};
  EXPECT_EQ(load_campaign(request).error().hint.find("means anything"), std::string::npos) << "who takes a column out knows it";
}

}  // namespace
}  // namespace forcegate
