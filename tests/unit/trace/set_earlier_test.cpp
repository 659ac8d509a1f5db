#include "hil/trace/set_earlier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace forcegate {
namespace {

constexpr double kStep_s = 0.01;

double sensor(double t) { return 1.0 + 0.4 * t; }

// Ten seconds at 100 Hz; the output shows what the force was `late_s` before, with or without a clock of its own.
Campaign late(double late_s, bool own_clock) {
  Campaign c;
  c.records.emplace_back().name = "r01";
  Trace& trace = c.records.front().trace;
  trace.time_bases.resize(own_clock ? 2 : 1);
  trace.channels.resize(2);
  trace.channels[0].name = "F_ref";
  trace.channels[1].name = "U";
  trace.channels[1].time_base = own_clock ? 1 : 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = kStep_s * i;
    for (TimeBase& clock : trace.time_bases) clock.t_s.push_back(t);
    trace.channels[0].value.push_back(t);
    trace.channels[1].value.push_back(sensor(t - late_s));
  }
  return c;
}

TEST(SetEarlier, TheOutputStandsWhereTheForceWas) {
  for (const bool own_clock : {false, true})
    for (const double late_s : {0.0231, -0.3, 1.0}) {
      Campaign c = late(late_s, own_clock);
      ASSERT_TRUE(set_output_earlier(c, late_s));
      const Trace& trace = c.records.front().trace;
      const Channel &F = *trace.find("F_ref"), &U = *trace.find("U");
      ASSERT_EQ(F.time_base, U.time_base);
      const std::vector<double>& t = trace.time_bases[F.time_base].t_s;
      ASSERT_EQ(t.size(), U.value.size());
      EXPECT_GT(t.size(), 850U);
      int seen = 0;
      for (std::size_t i = 0; i < t.size(); ++i)
        if (std::isfinite(U.value[i])) {
          ++seen;
          ASSERT_NEAR(U.value[i], sensor(F.value[i]), 1e-9) << late_s << ' ' << t[i];
        }
      EXPECT_GT(seen, 850) << late_s;
      EXPECT_THAT(c.notes, testing::ElementsAre(testing::HasSubstr("as asked")));
    }
}

TEST(SetEarlier, NothingIsDoneWhereNothingIsLate) {
  Campaign c = late(0.0, false);
  ASSERT_TRUE(set_output_earlier(c, 0.0));
  EXPECT_EQ(c.records.front().trace.time_bases.size(), 1U);
  EXPECT_TRUE(c.notes.empty());
}

TEST(SetEarlier, ARecordThatIsShorterIsAnErrorThatNamesIt) {
  Campaign c = late(0.0, false);
  const Result<void> r = set_output_earlier(c, 12.0);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().to_text(), testing::AllOf(testing::HasSubstr("12"), testing::HasSubstr("r01"), testing::HasSubstr("--late")));
}

}  // namespace
}  // namespace forcegate
