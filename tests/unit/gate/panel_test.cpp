// What a mean over specimens and sessions may claim: no more than its records do.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/gate/judge.h"

namespace forcegate {
namespace {

PanelValue value(double pct, double u_readings, double u_scatter) {
  PanelValue v;
  v.usable = true;
  v.value = pct;
  v.u_systematic = 0.54;
  v.u_readings = u_readings;
  v.u_scatter = u_scatter;
  return v;
}

// u of the promise of the maxima over `records`, one list a specimen.
double u_of(const std::vector<std::vector<PanelValue>>& records) {
  PlanCase planned;
  planned.name = "sine";
  planned.loop = LoopMode::closed;
  planned.checks = kCheckPromise;
  planned.maxima_pct = planned.minima_pct = 15.0;
  std::vector<std::vector<JudgedCase>> judged;
  for (const auto& of_one : records) {
    judged.emplace_back();
    for (const PanelValue& v : of_one) {
      JudgedCase& session = judged.back().emplace_back();
      session.maxima = session.minima = v;
    }
  }
  std::vector<SpecimenSessions> specimens;
  for (auto& of_one : judged) {
    specimens.push_back({"q" + std::to_string(specimens.size()), {}});
    for (JudgedCase& one : of_one) specimens.back().sessions.push_back(&one);
  }
  const auto checks = judge_panel(Plan{}, planned, specimens);
  EXPECT_FALSE(checks.empty());
  return checks.empty() ? 0.0 : checks.front().check.u;
}

const double kDeclared = PlanUncertainty{}.record_repeat_pct;

TEST(Panel, readings_that_the_declared_repeatability_knows_nothing_of_count_beside_it) {
  EXPECT_NEAR(u_of({{value(4.8, 11.25, 0.1)}}), std::hypot(0.54, kDeclared, 11.25), 1e-9);
  EXPECT_NEAR(u_of({{value(4.8, 0.11, 0.1)}}), std::hypot(0.54, kDeclared), 0.01) << "a good reference changes nothing";
}

TEST(Panel, what_is_random_shrinks_with_the_records_and_what_is_systematic_does_not) {
  const PanelValue v = value(4.8, 6.0, 0.1);
  EXPECT_NEAR(u_of({{v}, {v}}), std::hypot(0.54, std::hypot(kDeclared, 6.0) / std::sqrt(2.0)), 1e-9);
  EXPECT_NEAR(u_of({{v, v}, {v, v}}), std::hypot(0.54, std::hypot(kDeclared, 6.0) / 2.0), 1e-9);
}

TEST(Panel, a_record_whose_extrema_scatter_by_more_than_is_declared_counts_with_that) {
  EXPECT_NEAR(u_of({{value(4.8, 0.0, 5.0)}}), std::hypot(0.54, 5.0), 1e-9);
}

TEST(Panel, an_observed_spread_holds_the_noise_of_the_readings_already) {
  const auto spread = [](double u_readings) { return u_of({{value(-5.0, u_readings, 0.1), value(5.0, u_readings, 0.1)}}); };
  EXPECT_NEAR(spread(1.0), std::hypot(0.54, 5.0), 1e-3);
  EXPECT_NEAR(spread(30.0), std::hypot(0.54, 30.0 / std::sqrt(2.0)), 0.01) << "unless it is less than they are";
}

}  // namespace
}  // namespace forcegate
