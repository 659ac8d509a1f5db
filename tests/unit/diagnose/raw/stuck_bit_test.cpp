#include "hil/diagnose/raw/stuck_bit.h"

#include <gmock/gmock.h>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kCode_V = 10.0 / 4096.0;

// Bit `bit` of the converter of made_campaign.h stands at `level`.
Campaign with_stuck_bit(int bit, bool level) {
  Campaign c = make_campaign(71, straight);
  for (Record& r : c.records)
    for (double& u : r.trace.find("U")->value) {
      const int code = static_cast<int>(std::lround(u / kCode_V)), weight = 1 << bit;
      u = kCode_V * (level ? code | weight : code & ~weight);
    }
  return c;
}

TEST(StuckBit, IsNamedAndItsSamplesAreMended) {
  const Diagnosis clean = answer(make_campaign(71, straight));
  for (const int bit : {6, 7, 8})
    for (const bool level : {false, true}) {
      const Diagnosis d = answer(with_stuck_bit(bit, level));
      EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
      ASSERT_EQ(d.findings.size(), 1U) << bit << level;
      EXPECT_EQ(d.findings.front().effect, "adc_codes");
      EXPECT_NEAR(d.findings.front().parameters.front().value, kCode_V * (1 << bit), 2.0 * kCode_V);
      EXPECT_NEAR(d.error_after, clean.error_after, 0.2 * clean.error_after);
      EXPECT_GT(d.error_before, 0.3 * kCode_V * (1 << bit));
    }
}

TEST(StuckBit, LeavesAHealthyConverterAlone) {
  Campaign c = make_campaign(71, straight);
  const std::vector<double> before = c.records.front().trace.find("U")->value;
  std::vector<std::string> notes;
  EXPECT_FALSE(mend_stuck_bit(c, notes));
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(c.records.front().trace.find("U")->value, before);
}

// Levels as far apart as twice what the output scatters by on each of them.
TEST(StuckBit, IsNoStaircase) {
  Campaign c = make_campaign(71, straight);
  Rng rng(72, "staircase");
  for (Record& r : c.records) {
    auto &U = r.trace.find("U")->value, &F = r.trace.find("F_ref")->value;
    for (std::size_t i = 0; i < U.size(); ++i) {
      F[i] = 0.5 * static_cast<double>((i / 800) % 9);
      U[i] = 2.0 * F[i] + 0.5 * rng.uniform();
    }
  }
  std::vector<std::string> notes;
  EXPECT_FALSE(mend_stuck_bit(c, notes));
}

// A contact under a standing load that is now open, now closed, and a reference that knows nothing of it.
TEST(StuckBit, IsNoOutputThatHopsBetweenTwoLevels) {
  Campaign c = make_campaign(71, straight);
  Rng rng(73, "hops");
  for (Record& r : c.records) {
    auto &U = r.trace.find("U")->value, &F = r.trace.find("F_ref")->value;
    bool open = false;
    for (std::size_t i = 0; i < U.size(); ++i) {
      if (rng.uniform() < 0.01) open = !open;
      F[i] = 2.0 + 0.01 * rng.normal();
      U[i] = 4.0 + (open ? 0.3 : 0.0) + 0.12 * rng.uniform();
    }
  }
  std::vector<std::string> notes;
  EXPECT_FALSE(mend_stuck_bit(c, notes));
}

}  // namespace
}  // namespace forcegate::diagnose
