#include "hil/app/export/replayed_far_off.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace forcegate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReplayedFarOff, NamesTheRecordsThatAFirmwareMeetsOtherwiseThanTheFit) {
  diagnose::OneLawFit fit;
  fit.records = {{"ramp", 0.007, 0.007}, {"slow", 0.0075, 0.0075}, {"fast", 0.0144, 0.0144}};
  CompensatorCheck check;
  for (const auto& [name, error_N] : {std::pair{"ramp", 0.027}, std::pair{"slow", 0.18}, std::pair{"fast", 0.326}}) {
    ReplayedRecord r;
    r.record = name;
    r.plain_rms_N = r.compensated_rms_N = error_N;
    check.records.push_back(r);
  }
  for (const double gain : {0.5, -0.5}) {
    const std::string said = replayed_far_off(fit, check, gain);
    EXPECT_THAT(said, HasSubstr("fast 326 mN, fitted 7.2 mN; slow 180 mN, fitted 3.75 mN"));
    EXPECT_THAT(said, Not(HasSubstr("ramp")));
    EXPECT_THAT(said, HasSubstr("lowest output since it was switched on"));
  }
  for (ReplayedRecord& r : check.records) r.compensated_rms_N = 0.008;
  EXPECT_EQ(replayed_far_off(fit, check, 0.5), "");
}

}  // namespace
}  // namespace forcegate
