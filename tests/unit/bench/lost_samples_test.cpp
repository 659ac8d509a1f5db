// Samples that the link between board and harness lost are told as lost, in every record.

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/support/folder_test.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

class LostSamples : public FolderTest {
 protected:
  static constexpr std::size_t kRows = 1000;

  // Lost samples of a record of a second, among those before `until`.
  static std::size_t lost_of_record(Rig& rig, std::size_t until) {
    const auto begun = rig.begin(test::request_of_a_second());
    EXPECT_TRUE(begun) << begun.error().to_text();
    RigBlock block;
    block.resize(kRows);
    const auto ran = rig.run(kRows, block, 0);
    EXPECT_TRUE(ran) << ran.error().to_text();
    rig.park();
    std::size_t lost = 0;
    for (std::size_t i = 0; i < until; ++i) {
      lost += (block.status[i] & kRigSampleLost) != 0 ? 1U : 0U;
      EXPECT_GT(block.adc[i], 0) << "row " << i << " has the code of no sample";
    }
    return lost;
  }
};

TEST_F(LostSamples, TheEndOfOneRecordBlindsNoOther) {
  const auto path = put("bench.toml", test::bench_text("twin.toml") +
                                          "\n[[twins.fault]]\ndevice = \"board\"\nkind = \"drop\"\nat_s = 0.3\nfor_s = 0.009\n"
                                          "\n[[twins.fault]]\ndevice = \"board\"\nkind = \"drop\"\nat_s = 0.985\nfor_s = 0.03\n");  // three frames: the last of them is of no row
  auto rig = Registry<RigKind>::instance().find("bench")->make({{"file", path.string()}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  const std::size_t first = lost_of_record(**rig, kRows / 2);
  EXPECT_GT(first, 3U);
  EXPECT_EQ(lost_of_record(**rig, kRows / 2), first);
}

}  // namespace
}  // namespace forcegate
