#include "hil/app/diagnose/next_run.h"

#include <gtest/gtest.h>

#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

TEST(IsPlayable, NeedsASegmentThatTheRigCanPlayWithoutHeating) {
  NextExperiment planned;
  EXPECT_FALSE(is_playable(planned));
  planned.segments.resize(2);
  planned.segments[0].heats = planned.segments[1].heats = true;
  EXPECT_FALSE(is_playable(planned));
  planned.segments[1].heats = false;
  EXPECT_TRUE(is_playable(planned));
}

class NextRun : public FolderTest {};

TEST_F(NextRun, NoOtherSensorIsPlayedOnForAMystery) {
  put("sealed_truth.json", "{}");
  NextRunRequest request;
  request.campaign.campaign = folder_;
  request.named = {"--rig", "--seed"};
  const auto refused = next_run(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
  EXPECT_EQ(refused.error().text.substr(0, 15), "--rig, --seed: ") << refused.error().to_text();
}

}  // namespace
}  // namespace forcegate
