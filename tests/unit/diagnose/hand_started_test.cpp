// Two loggers that were started by hand: seconds apart.

#include "hil/model/shift_of_start.h"

#include <cmath>

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

double grasps(double t) { return 2.0 + std::sin(0.31 * t) + 0.6 * std::sin(0.83 * t + 1.0) + 0.3 * std::sin(2.1 * t + 2.0); }

// The output of a force that was logged `late_s` before it.
Campaign hand_started(double late_s, const std::function<double(double)>& force = grasps) {
  return recording(50.0, 9000, force, [&](const std::vector<double>& t, const std::vector<double>&) {
    std::vector<double> U;
    for (const double at : t) U.push_back(0.3 + 1.6 * force(at - late_s));
    return U;
  }, 0.003);
}

double found_delay_s(const Diagnosis& d) {
  for (const Finding& f : d.findings)
    if (f.effect == "delay" && f.claimed())
      for (const FoundParameter& p : f.parameters)
        if (p.name == "delay_s") return p.value;
  return 0.0;
}

TEST(HandStarted, SecondsApartIsADelay) {
  for (const double late_s : {1.7, 6.0, -4.0}) {
    const Diagnosis d = answer(hand_started(late_s));
    EXPECT_NEAR(found_delay_s(d), late_s, 0.01) << told(d);
    for (const Finding& f : d.findings) EXPECT_TRUE(f.effect == "delay" || !f.claimed()) << told(d);
  }
}

TEST(HandStarted, AtOnceIsNone) {
  const Diagnosis d = answer(hand_started(0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
}

CampaignInput rows(double late_s, const std::function<double(double)>& force) {
  CampaignInput c;
  RecordInput r;
  r.row_step_s = 0.05;
  for (int i = 0; i < 4000; ++i) {
    r.t_s.push_back(0.05 * i);
    r.F_N.push_back(force(r.t_s.back()));
    r.U_V.push_back(2.0 * force(r.t_s.back() - late_s) - 1.0);
  }
  r.ok.assign(r.t_s.size(), 1);
  r.duration_s = r.t_s.back();
  c.records.push_back(std::move(r));
  return c;
}

TEST(ShiftOfStart, IsThatOfTheRows) {
  for (const double late_s : {-20.0, -2.5, 0.7, 33.0}) EXPECT_NEAR(shift_of_start(rows(late_s, grasps)), late_s, 0.11) << late_s;
}

TEST(ShiftOfStart, OfCyclesIsTheSmallest) {
  const auto cycles = [](double t) { return 1.0 - std::cos(2.0 * 3.14159265358979 * t / 8.0); };
  EXPECT_NEAR(shift_of_start(rows(2.0, cycles)), 2.0, 0.11);
  EXPECT_NEAR(shift_of_start(rows(-22.0, cycles)), 2.0, 0.11);
}

TEST(ShiftOfStart, IsZeroWhereNoneHelps) {
  EXPECT_EQ(shift_of_start(rows(0.0, grasps)), 0.0);
  EXPECT_EQ(shift_of_start(rows(0.2, grasps)), 0.0);
  EXPECT_EQ(shift_of_start(rows(5.0, [](double) { return 1.0; })), 0.0);
  EXPECT_EQ(shift_of_start(CampaignInput{}), 0.0);
}

}  // namespace
}  // namespace forcegate::diagnose
