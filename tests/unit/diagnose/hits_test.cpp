// Hits of some milliseconds in records of half a second: rows of 20 ms would hold a whole hit.

#include <cmath>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 4000.0;

// Seven records of three hits each, 2 V/N; `lead_s`: at no load, of a charge that leads the force less and less with it.
Campaign hits(double lead_s) {
  Campaign c;
  c.name = "hits";
  c.bench.reference_resolution_N = 0.02;
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  for (int k = 0; k < 7; ++k) {
    Rng rng(90 + static_cast<std::uint64_t>(k), "hits");
    Record r;
    r.name = "hit" + std::to_string(k);
    r.kind = "impact";
    r.start_s = 300.0 * k;
    r.dynamic = false;
    r.role = k == 2 || k == 5 ? RecordRole::heldout : RecordRole::fit;
    TimeBase clock;
    std::vector<double> F(2400), U(2400);
    for (std::size_t i = 0; i < F.size(); ++i) clock.t_s.push_back(static_cast<double>(i) / kRate_Hz);
    for (const double at_s : {0.1, 0.25, 0.45}) {
      const double peak_N = 1.5 + 2.5 * rng.uniform(), width_s = 0.003 + 0.004 * rng.uniform();
      for (std::size_t i = 0; i < F.size(); ++i) F[i] += peak_N * std::exp(-std::pow((clock.t_s[i] - at_s) / width_s, 2));
    }
    for (double& f : F) f += 0.15;
    const double gain = 2.0 * (1.0 + 0.003 * rng.normal());
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double rate = (F[std::min(i + 1, F.size() - 1)] - F[i > 0 ? i - 1 : 0]) * 0.5 * kRate_Hz;
      U[i] = std::round((gain * (F[i] + lead_s * rate / (1.0 + 1.5 * F[i])) + 0.2 + 0.006 * rng.normal()) * 409.6) / 409.6;
    }
    for (double& f : F) f = std::round((f + 0.008 * rng.normal()) / 0.02) * 0.02;
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

TEST(Hits, OfAStraightSensorTellNothing) {
  const Diagnosis d = answer(hits(0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
}

TEST(Hits, ShowTheChargeOfAFilm) {
  const Diagnosis d = answer(hits(0.0006));
  EXPECT_GE(probability(d, "piezocapacitance"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
