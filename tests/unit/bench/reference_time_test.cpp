// What the adapter of the reference declares of its readings' time reaches the gate with the record.

#include <gtest/gtest.h>

#include <string>

#include "tests/support/folder_test.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

class ReferenceTime : public FolderTest {
 protected:
  double declared_s(const std::string& file, const test::Changes& changes = {}) {
    const auto path = put("bench.toml", test::bench_text(file, changes));
    auto rig = Registry<RigKind>::instance().find("bench")->make({{"file", path.string()}});
    EXPECT_TRUE(rig) << rig.error().to_text();
    if (!rig) return -1.0;
    const auto begun = (*rig)->begin(test::request_of_a_second());
    EXPECT_TRUE(begun) << begun.error().to_text();
    const double out_s = (*rig)->info().reference_u_time_s;
    (*rig)->park();
    return out_s;
  }
};

TEST_F(ReferenceTime, OfABoxOnTheNetworkIsThatOfTheFile) {
  EXPECT_EQ(declared_s("twin_netft.toml"), 0.0005);
  EXPECT_EQ(declared_s("twin_netft.toml", {{"u_time_s = 0.0005", "u_time_s = 0.02"}}), 0.02);
}

TEST_F(ReferenceTime, OfAControllerOnALineIsHalfAPeriod) { EXPECT_NEAR(declared_s("twin.toml"), 0.00182, 1e-4); }

}  // namespace
}  // namespace forcegate
