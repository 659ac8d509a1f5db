#include "hil/diagnose/raw/lost_blocks.h"

#include "hil/model/rows.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/turning_bench.h"

namespace forcegate::diagnose {
namespace {

constexpr double kBlock_s = 0.02;

// Sines of four minutes, two to four of them, beside slow ramps; `late_s` by which the output is behind at an instant of a record.
Campaign sines(const std::function<double(double t, int record)>& late_s, const std::function<double(double t)>& frequency_Hz = [](double) { return 0.5; },
               std::size_t records = 4) {
  const auto force = [&](double t) { return 2.0 + 1.2 * std::sin(2.0 * M_PI * frequency_Hz(t) * t); };
  Campaign c = make_campaign(5, [&](const std::vector<double>& t, const std::vector<double>& F, int k) {
    std::vector<double> U;
    for (const double at : t) {
      const double row = std::max(0.0, (at - late_s(at, k)) / (t[1] - t[0]));
      const auto i = std::min(F.size() - 2, static_cast<std::size_t>(row));
      U.push_back(0.2 + 2.0 * std::lerp(F[i], F[i + 1], std::min(1.0, row - static_cast<double>(i))));
    }
    return U;
  });
  c.records.resize(records);
  Rng rng(8, "sines");
  for (int k = 2; k < static_cast<int>(records); ++k) {
    if (k == 4 || k == 5) continue;
    Record& r = c.records[static_cast<std::size_t>(k)];
    r.kind = "sine";
    auto &t = r.trace.time_bases.front().t_s, &F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    t.clear(), F.clear(), U.clear();
    for (int i = 0; i < 48000; ++i) {
      t.push_back(i / 200.0);
      F.push_back(std::round((force(t.back()) + 0.006 * rng.normal()) / 0.025) * 0.025);
      U.push_back(std::round((0.2 + 2.0 * force(t.back() - late_s(t.back(), k)) + 0.004 * rng.normal()) * 409.6) / 409.6);
    }
  }
  return c;
}

double lost(double t) { return std::floor(t / 70.0); }

CampaignInput searched(const Campaign& c) {
  auto input = make_campaign_input(c);
  EXPECT_TRUE(input.has_value());
  find_lost_blocks(*input, 1);
  return *input;
}

TEST(LostBlocks, StepsOfTheShiftAreFoundWithTheirTimesAndTheirSize) {
  for (const double block_s : {kBlock_s, -kBlock_s}) {
    const CampaignInput found = searched(sines([&](double t, int) { return block_s * lost(t); }));
    EXPECT_NEAR(found.block_s, block_s, 0.03 * kBlock_s);
    for (std::size_t k = 2; k < 4; ++k) {
      const std::vector<LostBlocks>& steps = found.records[k].lost_blocks;
      ASSERT_EQ(steps.size(), 3u) << k;
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_NEAR(steps[j].from_s, 70.0 * static_cast<double>(j + 1), 1.0);
        EXPECT_NEAR(steps[j].blocks, static_cast<double>(j + 1), 0.05);
      }
    }
  }
}

TEST(LostBlocks, TimesThatAllRecordsShareHoldForThoseThatDoNotShowThem) {
  const CampaignInput found = searched(sines([](double t, int) { return kBlock_s * lost(t); }));
  ASSERT_EQ(found.records[0].lost_blocks.size(), 1u) << "a slow ramp of two minutes";
  EXPECT_NEAR(found.records[0].lost_blocks.front().from_s, 70.0, 1.0);
}

TEST(LostBlocks, TimesOfTheirOwnStayThoseOfTheirRecord) {
  const CampaignInput found = searched(sines([](double t, int k) { return kBlock_s * (t > (k == 2 ? 60.0 : 150.0) ? 1.0 : 0.0); }));
  EXPECT_TRUE(found.records[0].lost_blocks.empty());
  for (std::size_t k = 2; k < 4; ++k) {
    ASSERT_EQ(found.records[k].lost_blocks.size(), 1u);
    EXPECT_NEAR(found.records[k].lost_blocks.front().from_s, k == 2 ? 60.0 : 150.0, 1.0);
  }
}

TEST(LostBlocks, TwoClocksThatRunApartAsWellLeaveTheStepsAsTheyAre) {
  const CampaignInput found = searched(sines([](double t, int) { return kBlock_s * lost(t) + 1e-4 * t; }));
  EXPECT_NEAR(found.block_s, kBlock_s, 0.05 * kBlock_s);
  for (std::size_t k = 2; k < 4; ++k) {
    const std::vector<LostBlocks>& steps = found.records[k].lost_blocks;
    ASSERT_EQ(steps.size(), 3u) << k;
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(steps[j].from_s, 70.0 * static_cast<double>(j + 1), 1.0) << k;
  }
}

TEST(LostBlocks, NothingElseThatIsLateIsSteps) {
  EXPECT_EQ(searched(sines([](double, int) { return kBlock_s; })).block_s, 0.0) << "a delay";
  EXPECT_EQ(searched(sines([](double t, int) { return 2e-4 * t; })).block_s, 0.0) << "two clocks";
  EXPECT_EQ(searched(sines([](double t, int) { return 0.04 * -std::expm1(-t / 60.0); })).block_s, 0.0) << "a crystal that warms up";
  EXPECT_EQ(searched(sines([](double t, int) { return kBlock_s * (t > 80.0 && t < 160.0 ? 1.0 : 0.0); })).block_s, 0.0) << "there and back";
  const auto faster = [](double t) { return t < 120.0 ? 0.5 : 0.2; };
  EXPECT_EQ(searched(sines([](double t, int) { return t < 120.0 ? 0.01 : 0.03; }, faster)).block_s, 0.0) << "as late as the load is slow: a loop";
}

TEST(LostBlocks, TheDiagnosisClaimsThemWithTheirLength) {
  const auto slow = [](double) { return 0.5; };
  const Diagnosis d = answer(sines([](double t, int) { return kBlock_s * lost(t); }, slow, 8));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  ASSERT_FALSE(d.findings.empty());
  const Finding& f = d.findings.front();
  EXPECT_EQ(f.effect, "clock_skew") << told(d);
  EXPECT_GE(f.probability, 0.9);
  ASSERT_FALSE(f.parameters.empty());
  EXPECT_EQ(f.parameters.front().name, "block_s");
  EXPECT_NEAR(f.parameters.front().value, kBlock_s, 0.03 * kBlock_s);
  EXPECT_LT(d.error_after, 0.4 * d.error_before);
  EXPECT_TRUE(answer(sines([](double, int) { return 0.0; }, slow, 8)).findings.empty());
}

TEST(LostBlocks, AWheelThatPushesSidewaysAsWellIsNamedBesideThem) {
  Bench bench;
  bench.turns_Hz = {0.0, 0.21, 0.0, 0.35, 0.0, 0.56, 0.0};
  bench.push = [](double, double, double th) { return 0.2 * std::sin(th); };
  Campaign c = turning(bench);
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    const std::vector<double> whole = U;
    constexpr std::size_t kBlock = 4, kEvery = 7000;  // samples: 16 ms, 28 s
    for (std::size_t i = 0; i < U.size(); ++i) U[i] = whole[i - kBlock * std::min(i / kEvery, i / kBlock)];
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_GE(probability(d, "clock_skew"), 0.9) << told(d);
  EXPECT_GE(probability(d, "off_axis"), 0.9) << told(d);
  EXPECT_LT(d.error_after, 0.1 * d.error_before) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
