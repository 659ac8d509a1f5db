// Which record a claim is shown on.

#include "hil/diagnose/answer/claim_evidence.h"


#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

std::vector<double> with_play(const std::vector<double>& F) {
  constexpr double kPlay_N = 0.15;
  double held = F[0];
  std::vector<double> U;
  for (const double f : F) {
    held = std::clamp(held, f - kPlay_N, f + kPlay_N);
    U.push_back(1.6 * f + 0.4 * held + 0.2);
  }
  return U;
}

// Two records are held out, which stand at one force.
TEST(ClaimEvidence, WhereHeldOutRecordsHardlyShowItAnotherOneDoes) {
  Campaign c = make_campaign(71, [](const std::vector<double>&, const std::vector<double>& F, int) { return with_play(F); });
  Rng rng(72, "small");
  for (Record& r : c.records) {
    r.role = r.kind == "hold" ? RecordRole::heldout : RecordRole::fit;
    if (r.role != RecordRole::heldout) continue;
    std::vector<double>&F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    for (std::size_t i = 0; i < F.size(); ++i) {
      F[i] = 2.0 + 0.006 * rng.normal();
      U[i] = 4.2 + 0.004 * rng.normal();
    }
  }
  EngineOptions options;
  options.pictures = true;
  const auto d = diagnose_campaign(std::move(c), options);
  ASSERT_TRUE(d);
  ASSERT_FALSE(d->findings.empty()) << told(*d);
  const Finding& loop = d->findings.front();
  ASSERT_TRUE(loop.effect == "hysteresis" && loop.claimed()) << told(*d);
  const auto against_force = std::ranges::find(loop.series, "force", &EvidenceSeries::x_name);
  ASSERT_NE(against_force, loop.series.end());
  EXPECT_EQ(against_force->record.find_first_of("26"), std::string::npos) << against_force->record;
  double before = 0.0, after = 0.0;
  for (const double e : against_force->before) before += e * e;
  for (const double e : against_force->after) after += e * e;
  EXPECT_LT(after, 0.2 * before);
}

}  // namespace
}  // namespace forcegate::diagnose
