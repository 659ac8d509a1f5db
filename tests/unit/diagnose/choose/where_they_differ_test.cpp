#include "hil/diagnose/choose/where_they_differ.h"

#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Levels that last for seconds and edges of a twentieth: of ten minutes a fit sees every twelfth row.
Campaign levels(const Sensor& sensor) {
  Campaign c = make_campaign(6, straight);
  c.records.resize(5);
  Rng rng(9, "levels");
  for (std::size_t k = 1; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    r.kind = "steps";
    r.role = k == 4 ? RecordRole::heldout : RecordRole::fit;
    std::vector<double> t, F;
    double from = 0.5, to = 0.5, since = 0.0, lasts = 4.0;
    for (int i = 0; i < 120000; ++i) {
      t.push_back(i / 200.0);
      if (t.back() - since > lasts) {
        from = to, since = t.back();
        to = 0.5 + 3.6 * rng.uniform();
        lasts = 4.0 + 6.0 * rng.uniform();
      }
      constexpr double kEdge_s = 0.05;
      const double x = std::clamp((t.back() - since) / kEdge_s, 0.0, 1.0);
      F.push_back(from + (to - from) * 0.5 * (1.0 - std::cos(M_PI * x)));
    }
    std::vector<double> U = sensor(t, F, static_cast<int>(k));
    for (double& u : U) u = std::round((u + 0.01 * rng.normal()) * 409.6) / 409.6;
    for (double& f : F) f = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
    r.trace.time_bases.front().t_s = std::move(t);
    r.trace.find("F_ref")->value = std::move(F);
    r.trace.find("U")->value = std::move(U);
  }
  return c;
}

TEST(WhereTheyDiffer, EdgesThatAFitHardlySeesTellADelayFromALag) {
  const Diagnosis delay = answer(levels([](const std::vector<double>&, const std::vector<double>& F, int) {
    constexpr std::size_t kLate = 3;  // samples, 15 ms
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * F[i < kLate ? 0 : i - kLate] + 0.2);
    return U;
  }));
  EXPECT_GE(probability(delay, "delay"), 0.9) << told(delay);
  EXPECT_LT(probability(delay, "lag"), 0.05) << told(delay);
  const Diagnosis lag = answer(levels([](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : behind_pole(t, F, 0.015)) U.push_back(2.0 * f + 0.2);
    return U;
  }));
  EXPECT_GE(probability(lag, "lag"), 0.9) << told(lag);
  EXPECT_LT(probability(lag, "delay"), 0.05) << told(lag);
}

}  // namespace
}  // namespace forcegate::diagnose
