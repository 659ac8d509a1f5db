#include "hil/app/diagnose/next_run.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace forcegate
