// What records are to each other: mountings and start times.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "hil/model/rows.h"
#include "synthetic.h"

namespace forcegate {
namespace {

CampaignInput input() {
  auto made = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F - 0.2; }));
  EXPECT_TRUE(made.has_value());
  return std::move(*made);
}

TEST(Mounting, IsThatOfTheNeighboursWhereARecordDoesNotSay) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 3u);
  campaign.records.resize(3);
  const auto numbered = [&](std::vector<std::string> names) {
    for (std::size_t k = 0; k < names.size(); ++k) campaign.records[k].mounting_name = names[k];
    for (RecordInput& r : campaign.records) r.mounting = -1;
    campaign.mountings = 0;
    finish_campaign_input(campaign);
    std::vector<int> out = {campaign.mountings};
    for (const RecordInput& r : campaign.records) out.push_back(r.mounting);
    return out;
  };
  EXPECT_EQ(numbered({"a", "b", "a"}), (std::vector<int>{2, 0, 1, 0}));
  EXPECT_EQ(numbered({"a", "", "a"}), (std::vector<int>{1, 0, 0, 0}));
  EXPECT_EQ(numbered({"", "a", "b"}), (std::vector<int>{2, 0, 0, 1}));
  EXPECT_EQ(numbered({"a", "", "b"}).front(), 0);
  EXPECT_EQ(numbered({"", "", ""}).front(), 0);
}

// A load of 1 % of the range, or what the reference makes of one.
TEST(StandingForce, IsOneThatTheOutputDoesNotFollow) {
  const auto moves = [](double load_N, double seen_N) {
    Campaign c = test::campaign([](double, double F) { return 2.0 * F - 0.2; });
    c.records.push_back(test::record("still", "rest", 60, 2000, [=](double t) { return 0.5 + load_N * std::sin(0.2 * t); }, [](double, double F) { return 2.0 * F - 0.2; }));
    auto& F = c.records.back().trace.find("F_ref")->value;
    for (std::size_t i = 0; i < F.size(); ++i) F[i] += seen_N * std::sin(0.001 * static_cast<double>(i));
    auto made = make_campaign_input(c);
    EXPECT_TRUE(made.has_value());
    const std::vector<double>& rows = made->records.back().F_N;
    return *std::ranges::max_element(rows) > *std::ranges::min_element(rows);
  };
  EXPECT_TRUE(moves(0.03, 0.0));
  EXPECT_FALSE(moves(0.0, 0.03));
  EXPECT_TRUE(moves(0.0, 0.3)) << "far beyond what stands still";
}

TEST(MissingFacts, OfSomeRecordsAreTold) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 3u);
  campaign.records.resize(3);
  for (std::size_t k = 0; k < 3; ++k) campaign.records[k].name = "r" + std::to_string(k + 1), campaign.records[k].temp_C.clear(), campaign.records[k].humidity.clear();
  const auto notes = [&](auto&& change) {
    CampaignInput changed = campaign;
    change(changed.records);
    finish_campaign_input(changed);
    return changed.notes;
  };
  using Records = std::vector<RecordInput>;
  const auto air = [](std::vector<double> RecordInput::*channel, std::size_t records) {
    return [=](Records& r) {
      for (std::size_t k = 0; k < records; ++k) (r[k].*channel).assign(r[k].rows(), 20.0 + static_cast<double>(k));
    };
  };
  const auto drive = [](std::vector<double> V) {
    return [=](Records& r) {
      for (std::size_t k = 0; k < V.size(); ++k) r[k].drive_mean_V = V[k];
    };
  };
  const auto of = [](const char* key) { return ::testing::Contains(::testing::HasSubstr(key)); };
  EXPECT_THAT(notes(drive({5.0, 3.3})), of("r3 has no drive_V"));
  EXPECT_THAT(notes(drive({5.0, 3.3})), of("(bias) cannot be asked"));
  EXPECT_THAT(notes(drive({5.0})), of("r2, r3 have no drive_V"));
  EXPECT_THAT(notes(drive({5.0, 5.0})), ::testing::Not(of("drive_V"))) << "there is nothing to ask";
  EXPECT_THAT(notes(drive({5.0, 3.3, 5.0})), ::testing::Not(of("drive_V")));
  EXPECT_THAT(notes(air(&RecordInput::temp_C, 2)), of("r3 has no temperature (temp_C)"));
  EXPECT_THAT(notes(air(&RecordInput::temp_C, 3)), ::testing::Not(of("temp_C")));
  EXPECT_THAT(notes(air(&RecordInput::humidity, 1)), of("r2, r3 have no humidity_pct"));
  EXPECT_THAT(notes([](Records& r) { r[0].mounting_name = "a", r[2].mounting_name = "b"; }), of("r2 has no mounting"));
  EXPECT_THAT(notes([](Records& r) { r[0].mounting_name = "a", r[2].mounting_name = "a"; }), ::testing::Not(of("mounting"))) << "its neighbours tell";
  EXPECT_THAT(notes([](Records& r) { r[0].start_s = 0.0, r[2].start_s = 1e5, r[1].start_s = kMissing; for (RecordInput& one : r) one.rest_before_s = kMissing; }), of("r2 has no start_s"));
  EXPECT_TRUE(notes([](Records&) {}).empty()) << "what none has is asked of none";
}

TEST(MissingFacts, OfTheWheelAreToldWhereTheOthersWouldTellItsSpring) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 4u);
  for (RecordInput& r : campaign.records) r.theta_rad.assign(r.rows(), 1.0), r.eccentricity_mm = 11.0, r.preload_mm = 1.6;
  CampaignInput all = campaign;
  finish_campaign_input(all);
  EXPECT_THAT(all.notes, ::testing::Not(::testing::Contains(::testing::HasSubstr("eccentricity_mm"))));
  campaign.records.back().preload_mm = kMissing;
  finish_campaign_input(campaign);
  EXPECT_THAT(campaign.notes, ::testing::Contains(::testing::HasSubstr("has no eccentricity_mm and preload_mm")));
}

TEST(Air, AColumnOfTheHumidityIsReadInPercentAsTheRecordsOwnReadingIs) {
  Campaign made = test::campaign([](double, double F) { return 2.0 * F - 0.2; });
  for (std::size_t k = 0; k < made.records.size(); ++k) {
    Record& r = made.records[k];
    if (k == 0) r.humidity_pct = 45.0;
    else r.trace.channels.push_back({"humidity", "1", "ratio", 0, std::vector<double>(r.trace.time_bases[0].t_s.size(), 0.45), {}});
  }
  const auto read = make_campaign_input(std::move(made));
  ASSERT_TRUE(read.has_value());
  EXPECT_TRUE(read->has_humidity);
  for (const RecordInput& r : read->records) EXPECT_NEAR(r.humidity.at(0), 45.0, 1e-9) << r.name;
}

TEST(StartTimes, AreThoseOfAClockThatGoesOnFromRecordToRecord) {
  CampaignInput campaign = input();
  ASSERT_GE(campaign.records.size(), 3u);
  campaign.records.resize(3);
  const auto starts = [&](std::array<double, 3> clock_s) {
    for (std::size_t k = 0; k < 3; ++k) {
      campaign.records[k].start_s = campaign.records[k].rest_before_s = kMissing;
      campaign.records[k].clock_start_s = clock_s[k];
    }
    campaign.has_start_times = true;
    finish_campaign_input(campaign);
    std::vector<double> out = {campaign.has_start_times ? 1.0 : 0.0};
    for (const RecordInput& r : campaign.records) out.push_back(r.start_s);
    return out;
  };
  EXPECT_EQ(starts({1.7e9, 1.7e9 + 5000.0, 1.7e9 + 12000.0}), (std::vector<double>{1.0, 0.0, 5000.0, 12000.0}));
  EXPECT_EQ(starts({9000.0, 1000.0, 5000.0}), (std::vector<double>{1.0, 0.0, 4000.0, 8000.0})) << "named in another order";
  EXPECT_EQ(starts({0.0, 0.0, 0.0}).front(), 0.0) << "a clock of each record's own";
  EXPECT_EQ(starts({2.0, 1.5, 3.0}).front(), 0.0) << "no record begins before another has ended";
}

Record sampled(const std::vector<double>& t_s) {
  Record record;
  record.name = "sampled";
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}};
  for (const double t : t_s) {
    F.value.push_back(1.0 + t);
    U.value.push_back(2.0 * t);
  }
  record.trace.time_bases.push_back({"rig", t_s, 0.0, {}, false});
  record.trace.channels = {F, U};
  return record;
}

TEST(Rows, AreEquallyLongWhereTheRateChanges) {
  std::vector<double> t_s;
  for (int i = 0; i < 1000; ++i) t_s.push_back(0.01 * i);       // 100 Hz
  for (int i = 0; i < 500; ++i) t_s.push_back(10.0 + 0.1 * i);  // 10 Hz
  const auto made = make_record_input(sampled(t_s));
  ASSERT_TRUE(made.has_value());
  ASSERT_EQ(made->rows(), 1000u) << "two samples a row at first, one afterwards";
  for (std::size_t r = 0; r < made->rows(); ++r) {
    EXPECT_EQ(made->ok[r], 1) << r;
    EXPECT_NEAR(made->F_N[r], 1.0 + made->t_s[r], 1e-9) << r;
  }
}

TEST(Rows, AreTheSameWhereverTheClockBegins) {
  const auto made = [](double begins_s) {
    Record r;
    r.name = "clock";
    TimeBase clock;
    std::vector<double> F, U;
    for (int i = 0; i < 4000; ++i) {
      clock.t_s.push_back(begins_s + i / 50.0);
      F.push_back(2.0 - std::cos(2.0 * 3.14159265358979 * 2.0 * i / 50.0));
      U.push_back(2.0 * F.back());
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    return make_record_input(r, {}, 0.02, {.full_rate = true});
  };
  const auto at_zero = made(0.0);
  ASSERT_TRUE(at_zero) << at_zero.error().to_text();
  for (const double begins_s : {1000.0, 12345.0, 1e5}) {
    const auto later = made(begins_s);
    ASSERT_TRUE(later) << later.error().to_text();
    EXPECT_EQ(later->t_s, at_zero->t_s) << begins_s;
    EXPECT_EQ(later->fast_t_s, at_zero->fast_t_s) << begins_s;
    EXPECT_EQ(later->rate_N_per_s, at_zero->rate_N_per_s) << begins_s;
  }
}

TEST(Rows, OfASlowTableAreItsSamplesHoweverItsStampsAreRounded) {
  for (const double period_s : {5.0, 1.6, 1.4}) {
    std::vector<double> t_s;
    for (int i = 0; i < 24; ++i) t_s.push_back(std::nearbyint(2.5 + period_s * i));
    const auto made = make_record_input(sampled(t_s));
    ASSERT_TRUE(made.has_value());
    EXPECT_EQ(made->rows(), 24u) << period_s;
    EXPECT_NEAR(made->row_step_s, period_s, 0.2 * period_s);
  }
}

TEST(Rows, AfterAHoleAreNotOk) {
  std::vector<double> t_s;
  for (int i = 0; i < 1000; ++i) t_s.push_back(0.01 * i + (i >= 501 ? 3.0 : 0.0));
  const auto made = make_record_input(sampled(t_s));
  ASSERT_TRUE(made.has_value());
  std::size_t bad = 0;
  for (std::size_t r = 0; r < made->rows(); ++r) {
    bad += made->ok[r] == 0;
    EXPECT_NEAR(made->F_N[r], 1.0 + made->t_s[r], 1e-9) << "no row reaches over the hole";
  }
  EXPECT_EQ(bad, 1u);
}

}  // namespace
}  // namespace forcegate
