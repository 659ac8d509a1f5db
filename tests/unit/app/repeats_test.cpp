#include "hil/app/gate/repeats.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

CaseRecord played(const std::string& digest) {
  CaseRecord r;
  r.id = "sine/q50";
  r.rig.name = "emulated";
  r.digest = digest;
  r.pairs = {{.t_s = 1.0, .dut_N = 2.0}};
  return r;
}

using Is = SecondPlay::Is;

TEST(SecondPlay, of_the_same_digest_is_the_first) {
  EXPECT_EQ(compare_plays(played("a"), played("a")).is, Is::same);
  EXPECT_FALSE(repeats_check({}));
}

TEST(SecondPlay, that_differs_is_the_firmwares) {
  CaseRecord again = played("b");
  again.pairs[0].dut_N = 2.25;
  const SecondPlay found = compare_plays(played("a"), again);
  EXPECT_EQ(found.is, Is::other_by_firmware);
  EXPECT_NE(found.text.find("extrema up to 0.25 N apart"), std::string::npos) << found.text;
  again.failure = CaseFailure{CaseFailure::Stage::firmware, {ErrorCode::firmware, "the firmware crashed", "", ""}, Blame::none, 0};
  EXPECT_EQ(compare_plays(played("a"), again).is, Is::other_by_firmware);
  const auto check = repeats_check(std::vector<std::string>{found.text, found.text});
  ASSERT_TRUE(check);
  EXPECT_FALSE(check->judgeable);
  EXPECT_TRUE(check->check.required);
  EXPECT_EQ(check->check.verdict, Verdict::fail);
  EXPECT_EQ(check->check.blame, Blame::firmware);
}

TEST(SecondPlay, charges_no_firmware_with_what_another_may_have_done) {
  CaseRecord lossy = played("b");
  lossy.link.indices_lost = 1;
  EXPECT_EQ(compare_plays(played("a"), lossy).is, Is::other);
  EXPECT_EQ(compare_plays(lossy, played("a")).is, Is::other);
  CaseRecord bench = played("a");
  bench.rig.name = "bench";
  EXPECT_EQ(compare_plays(bench, played("b")).is, Is::other);
  CaseRecord dead = played("");
  dead.failure = CaseFailure{CaseFailure::Stage::rig, {ErrorCode::device, "no power", "", ""}, Blame::none, 0};
  EXPECT_EQ(compare_plays(played("a"), dead).is, Is::other);
  dead.failure->error.code = ErrorCode::cancelled;
  EXPECT_EQ(compare_plays(played("a"), dead).is, Is::cancelled);
}

}  // namespace
}  // namespace forcegate
