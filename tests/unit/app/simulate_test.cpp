#include "hil/app/model/simulate.h"

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

TEST_F(Simulate, AMapThatTakesTheOutputAwayIsNamed) {
  CampaignRequest request;
  request.campaign = put("film.csv", "t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,3\n0.2,1,2\n");
  request.maps = {"U_V=F_ref_N"};
  const auto campaign = load_campaign(request);
  ASSERT_FALSE(campaign);
  EXPECT_NE(campaign.error().hint.find("--map U_V=F_ref_N made another thing of it"), std::string::npos) << campaign.error().to_text();
  EXPECT_EQ(campaign.error().text.find("F_ref_N_N"), std::string::npos) << campaign.error().to_text();
}

}  // namespace
}  // namespace forcegate
