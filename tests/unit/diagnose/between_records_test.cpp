#include <algorithm>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Temperature of a record, degC: ten degrees over the campaign, in no order.
constexpr double kTemperature[] = {20.0, 26.0, 17.0, 23.0, 19.0, 27.0, 24.0, 18.0};

Campaign in_a_warm_room(std::uint64_t seed, double gain_per_C) {
  Campaign c = make_campaign(seed, [&](const std::vector<double>&, const std::vector<double>& F, int record) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f * (1.0 + gain_per_C * (kTemperature[record] - 22.0)) + 0.2);
    return U;
  });
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    r.trace.channels.push_back({"temp", "C", "temperature", 0, std::vector<double>(r.trace.time_bases[0].t_s.size(), kTemperature[k]), {}});
  }
  return c;
}

TEST(BetweenRecords, ATemperatureIsJudgedWhereGainAndZeroAreThoseOfAllRecords) {
  const Diagnosis d = answer(in_a_warm_room(71, 0.01));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "thermal");
  EXPECT_GE(d.findings.front().probability, 0.5);
  EXPECT_TRUE(d.levels);
  EXPECT_LT(d.error_after, 0.5 * d.error_before);
  EXPECT_LT(d.findings.front().error_after, 0.5 * d.findings.front().error_before);
}

TEST(BetweenRecords, ATemperatureThatTheSensorDoesNotMindIsNoFinding) {
  for (std::uint64_t seed = 71; seed <= 73; ++seed) {
    const Diagnosis d = answer(in_a_warm_room(seed, 0.0));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << seed;
    EXPECT_FALSE(d.levels) << seed;
  }
}

// The zero creeps up over the campaign.
Campaign with_a_course(bool times) {
  Campaign c = make_campaign(74, [](const std::vector<double>&, const std::vector<double>& F, int record) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f + 0.2 + 0.3 * std::log1p(record));
    return U;
  });
  if (!times)
    for (Record& r : c.records) r.start_s = std::nullopt;
  return c;
}

TEST(BetweenRecords, ACourseOverTimeNeedsTheTimes) {
  const auto largest = [](const Diagnosis& d) {
    double out = 0.0;
    for (const Finding& f : d.findings) out = std::max(out, f.probability);
    return out;
  };
  EXPECT_GE(largest(answer(with_a_course(true))), 0.5);
  const Diagnosis d = answer(with_a_course(false));
  EXPECT_LT(largest(d), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
