#include "hil/app/export/recorded_rate.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

Campaign of_rates(const std::vector<double>& rates_Hz) {
  Campaign out;
  for (const double rate_Hz : rates_Hz) {
    Record r;
    r.trace.time_bases.resize(2);
    r.trace.time_bases[0].nominal_rate_Hz = 1.0;
    r.trace.time_bases[1].nominal_rate_Hz = rate_Hz;
    r.trace.channels.resize(2);
    r.trace.channels[0].name = "F_ref";
    r.trace.channels[1].name = "U";
    r.trace.channels[1].time_base = 1;
    out.records.push_back(std::move(r));
  }
  return out;
}

TEST(RecordedRate, IsThatOfTheOutputWhereAllRecordsHaveOne) {
  EXPECT_DOUBLE_EQ(recorded_rate_Hz(of_rates({99.998, 100.001})), 100.0);
  EXPECT_DOUBLE_EQ(recorded_rate_Hz(of_rates({12.5})), 12.5);
  EXPECT_DOUBLE_EQ(recorded_rate_Hz(of_rates({100.0, 200.0})), 0.0);
  EXPECT_DOUBLE_EQ(recorded_rate_Hz(of_rates({100.0, 0.0})), 0.0) << "a clock that is not uniform";
  EXPECT_DOUBLE_EQ(recorded_rate_Hz(Campaign{}), 0.0);
}

TEST(RecordedRate, IsToldWhereTheHeaderHasAnotherOne) {
  EXPECT_NE(note_of_rate(1000.0, 100.0).find("needs --rate 100,"), std::string::npos);
  EXPECT_EQ(note_of_rate(1000.0, 1000.0), "");
  EXPECT_EQ(note_of_rate(1000.0, 0.0), "");
}

}  // namespace
}  // namespace forcegate
