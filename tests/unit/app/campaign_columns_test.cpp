// What a verb says of a recording whose columns it cannot place: which file, which line, and a command that can be pasted.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hil/app/model/model_input.h"
#include "hil/model/rows.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

class CampaignColumns : public FolderTest {
 protected:
  CampaignRequest put(const std::string& text) {
    CampaignRequest request;
    request.campaign = FolderTest::put("run.csv", text);
    return request;
  }
};

TEST_F(CampaignColumns, TheHintForAWeightInGramsCanBePastedAndTheHeadersLineIsNamed) {
  const auto campaign = load_campaign(put("# bench 2\nt_s,Force (g),U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().where, EndsWith("run.csv:2"));
  EXPECT_THAT(campaign.error().hint, HasSubstr("--map 'Force_(g)=F_ref_gf'"));
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

TEST_F(CampaignColumns, ARecordThatIsTooShortIsNamedByItsFile) {
  const auto campaign = load_campaign(put("t_s,F_ref_N,U_V\n0,1,2\n1,2,3\n2,3,4\n"));
  ASSERT_TRUE(campaign);
  const auto rows = make_campaign_input(*campaign, 1);
  ASSERT_FALSE(rows);
  EXPECT_THAT(rows.error().where, EndsWith("run.csv"));
}

}  // namespace
}  // namespace forcegate
