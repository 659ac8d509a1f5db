// When and how a record is loaded: where it begins, its frequency and the instants at which that changes.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

// A record whose clock shows 12 s at its first row, and a load that begins to swing 5 s later.
TEST(Excitation, ItsStartIsReadByTheClockOfTheFileOrSinceItsFirstRow) {
  for (const double written_s : {17.0, 5.0}) {
    Record r = test::record(
        "swing", "sine", 60, 0, [](double t) { return t < 5.0 ? 1.0 : 2.0 - std::cos(2.0 * std::numbers::pi * (t - 5.0)); },
        [](double, double F) { return 2.0 * F; });
    for (double& t : r.trace.time_bases[0].t_s) t += 12.0;
    r.dynamic = true;
    r.excitation_start_s = written_s;
    Campaign c;
    c.records.push_back(std::move(r));
    const auto input = make_campaign_input(c);
    ASSERT_TRUE(input) << input.error().to_text();
    EXPECT_EQ(input->records[0].onset_s, 5.0) << written_s;
  }
}

// 0.5 Hz for a minute, then 2 Hz for one: most half periods are those of 2 Hz.
TEST(Excitation, ItsFrequencyIsThatOfTheFirstCycles) {
  Record r = test::record(
      "switch", "sine", 120, 0, [](double t) { return 2.0 - std::cos(2.0 * std::numbers::pi * (t < 60.0 ? 0.5 : 2.0) * t); }, [](double, double F) { return 2.0 * F; });
  r.dynamic = true;
  Campaign c;
  c.records.push_back(std::move(r));
  const auto input = make_campaign_input(c);
  ASSERT_TRUE(input) << input.error().to_text();
  ASSERT_EQ(input->records[0].frequency_jumps_s.size(), 1U);
  EXPECT_NEAR(input->records[0].f_Hz, 0.5, 0.01);
  EXPECT_NEAR(input->records[0].onset_s, 0.0, 0.1);
}

// The phase runs on; two cycles stand between two changes, the second of which lies within a half period.
TEST(Excitation, ChangesOfFrequencyAreDatedWithinTheirHalfPeriod) {
  const auto phase = [](double t) { return t < 20.25 ? t : t < 24.0 ? 20.25 + 0.5 * (t - 20.25) : 22.125 + 2.0 * (t - 24.0); };
  Record r = test::record(
      "switch", "sine", 40, 0, [&](double t) { return 2.0 - std::cos(2.0 * std::numbers::pi * phase(t)); }, [](double, double F) { return 2.0 * F; });
  r.dynamic = true;
  Campaign c;
  c.records.push_back(std::move(r));
  const auto input = make_campaign_input(c);
  ASSERT_TRUE(input) << input.error().to_text();
  const RecordInput& record = input->records[0];
  ASSERT_EQ(record.frequency_jumps_s.size(), 2U);
  EXPECT_NEAR(record.frequency_jumps_s[0], 20.25, 0.05);
  EXPECT_NEAR(record.frequency_jumps_s[1], 24.0, 0.05);
  EXPECT_NEAR(record.jump_log_ratio[0], std::log(0.5), 0.03);
  EXPECT_NEAR(record.jump_log_ratio[1], std::log(4.0), 0.03);
}

// Three half periods are alike now and then, and no dwell.
TEST(Excitation, ASumOfSinesHasNoChangeOfFrequency) {
  for (const double phase : {0.0, 1.0, 2.0, 3.0}) {
    const auto force = [&](double t) {
      return 2.5 + std::sin(2.0 * std::numbers::pi * 0.1 * t + phase) + 0.7 * std::sin(2.0 * std::numbers::pi * 0.37 * t + 2.0 * phase) +
             0.3 * std::sin(2.0 * std::numbers::pi * 1.1 * t + 3.0 * phase);
    };
    Campaign c;
    c.records.push_back(test::record("hand", "", 300, 0, force, [](double, double F) { return 2.0 * F; }));
    c.records.front().dynamic = true;
    const auto input = make_campaign_input(c);
    ASSERT_TRUE(input) << input.error().to_text();
    EXPECT_TRUE(input->records[0].frequency_jumps_s.empty()) << phase;
  }
}

}  // namespace
}  // namespace forcegate
