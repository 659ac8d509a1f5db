#include "hil/diagnose/choose/at_the_edges.h"

#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 400.0;

// Levels every second, reached within some 15 ms: rows of 20 ms hold an edge as one step.
Campaign quick_levels(std::uint64_t seed, const Sensor& sensor) {
  Campaign c = make_campaign(seed, straight);
  c.records.resize(5);
  Rng rng(seed, "quick levels");
  for (std::size_t k = 1; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    r.kind = "steps";
    r.role = k == 4 ? RecordRole::heldout : RecordRole::fit;
    std::vector<double> t, F;
    double from = 0.5, to = 0.5, since = 0.0;
    for (int i = 0; i < 24000; ++i) {
      t.push_back(i / kRate_Hz);
      if (t.back() - since > 1.0) {
        from = to, since = t.back();
        to = 0.5 + 3.6 * rng.uniform();
      }
      constexpr double kEdge_s = 0.015;
      const double x = std::clamp((t.back() - since) / kEdge_s, 0.0, 1.0);
      F.push_back(from + (to - from) * 0.5 * (1.0 - std::cos(M_PI * x)));
    }
    std::vector<double> U = sensor(t, F, static_cast<int>(k));
    for (double& u : U) u = std::round((u + 0.01 * rng.normal()) * 409.6) / 409.6;
    for (double& f : F) f = std::round((f + 0.012 * rng.normal()) / 0.01) * 0.01;
    r.trace.time_bases.front().t_s = std::move(t);
    r.trace.find("F_ref")->value = std::move(F);
    r.trace.find("U")->value = std::move(U);
  }
  return c;
}

std::vector<double> volts(std::vector<double> F) {
  for (double& f : F) f = 2.0 * f + 0.2;
  return F;
}

Diagnosis behind_delay(std::uint64_t seed, double delay_s) {
  return answer(quick_levels(seed, [=](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> y;
    const double late = delay_s * kRate_Hz;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double at = std::max(0.0, static_cast<double>(i) - late);
      const auto before = static_cast<std::size_t>(at);
      y.push_back(std::lerp(F[before], F[std::min(before + 1, F.size() - 1)], at - static_cast<double>(before)));
    }
    return volts(std::move(y));
  }));
}

Diagnosis behind_lag(std::uint64_t seed, double tau_s) {
  return answer(quick_levels(seed, [=](const std::vector<double>& t, const std::vector<double>& F, int) { return volts(behind_pole(t, F, tau_s)); }));
}

// A fifth of a row.
TEST(AtTheEdges, ADelayAndALagOfAFewMillisecondsAreToldApart) {
  constexpr double kFew_s = 0.004;
  const Diagnosis delay = behind_delay(21, kFew_s), lag = behind_lag(21, kFew_s);
  EXPECT_GE(probability(delay, "delay"), 0.9) << told(delay);
  EXPECT_LT(probability(delay, "lag"), 0.2) << told(delay);
  EXPECT_GE(probability(lag, "lag"), 0.9) << told(lag);
  EXPECT_LT(probability(lag, "delay"), 0.2) << told(lag);
}

// How the force ran between two samples nobody saw: a third of that is no evidence.
TEST(AtTheEdges, NothingIsSaidOfAShiftByLessThanHalfASample) {
  constexpr double kThird_s = 0.33 / kRate_Hz;
  for (const Diagnosis& d : {behind_delay(21, kThird_s), behind_lag(21, kThird_s)})
    EXPECT_TRUE(std::ranges::none_of(d.notes, [](const std::string& note) { return note.find("turns most sharply") != std::string::npos; })) << told(d);
}

// A lag smooths the reference's noise and leaves less of it: that is no evidence.
TEST(AtTheEdges, NothingIsSaidOfAForceThatNeverTurns) {
  Campaign slow = make_campaign(5, [](const std::vector<double>& t, const std::vector<double>& F, int) { return volts(behind_pole(t, F, 0.03)); });
  std::erase_if(slow.records, [](const Record& r) { return r.kind != "ramp"; });
  const Diagnosis d = answer(std::move(slow));
  EXPECT_TRUE(std::ranges::none_of(d.notes, [](const std::string& note) { return note.find("turns most sharply") != std::string::npos; })) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
