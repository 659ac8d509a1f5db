#include "hil/app/bench/rig_history.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

std::vector<double> steady(int n, std::uint64_t seed = 3) {
  Rng rng(seed, "visits");
  std::vector<double> x;
  for (int i = 0; i < n; ++i) x.push_back(rng.normal(0.010, 0.001));
  return x;
}

TEST(ControlChart, says_nothing_before_there_are_enough_visits) {
  std::vector<double> x = steady(5);
  x.push_back(1.0);
  const ControlChart c = control_chart("noise", x, 1e-6);
  EXPECT_FALSE(c.enough);
  EXPECT_TRUE(c.in_control);
}

TEST(ControlChart, a_steady_rig_stays_in_control) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed)
    alarms += !control_chart("noise", steady(40, seed), 1e-6).in_control;
  EXPECT_LE(alarms, 12) << "two charts at three standard deviations, spread from 20 visits";
}

TEST(ControlChart, a_healthy_rig_alarms_in_one_visit_of_a_hundred_over_all_its_charts) {
  constexpr std::size_t kCharts = 25;
  for (const int visits : {9, 13, 21, 41}) {
    int alarms = 0;
    for (std::uint64_t visit = 0; visit < 200; ++visit) {
      bool alarm = false;
      for (std::size_t k = 0; k < kCharts; ++k)
        alarm = alarm || !control_chart("noise", steady(visits, 1000 * visit + k), 1e-6, kCharts).in_control;
      alarms += alarm;
    }
    EXPECT_LE(alarms, 6) << visits << " visits: 2 are expected, three standard deviations gave 60";
  }
}

TEST(ControlChart, a_jump_is_seen_at_once) {
  std::vector<double> x = steady(25);
  x.push_back(0.016);
  const ControlChart c = control_chart("noise", x, 1e-6);
  EXPECT_FALSE(c.in_control);
  EXPECT_NE(c.text.find("standard deviations"), std::string::npos) << c.text;
  EXPECT_FALSE(control_chart("noise", x, 1e-6, 25).in_control) << "six standard deviations, among as many charts as a visit has";
}

TEST(ControlChart, a_slow_drift_is_seen_by_the_moving_mean_before_any_single_value_is_out) {
  std::vector<double> x = steady(25);
  bool seen = false;
  for (int i = 0; i < 40 && !seen; ++i) {
    x.push_back(0.0118);  // under two standard deviations
    const ControlChart c = control_chart("noise", x, 1e-6);
    if (c.in_control) continue;
    seen = true;
    EXPECT_NE(c.text.find("drifted"), std::string::npos) << c.text;
  }
  EXPECT_TRUE(seen);
}

TEST(ControlChart, a_quantity_that_never_varied_alarms_at_its_resolution_and_not_below) {
  std::vector<double> x(12, 0.5);
  x.push_back(0.5 + 1e-7);
  EXPECT_TRUE(control_chart("slope", x, 1e-4).in_control);
  x.back() = 0.51;
  EXPECT_FALSE(control_chart("slope", x, 1e-4).in_control);
}

TEST(RigHistory, says_which_line_was_cut_off_and_keeps_visits_apart) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("history_cut_" + std::to_string(::getpid()) + ".jsonl");
  std::filesystem::remove(path);
  ASSERT_TRUE(append_visit(path, {"2026-01-01", "r", "f", "ACCEPT", {{"noise", 0.1}}}));
  std::ofstream(path, std::ios::app) << R"({"format":1,"date":"2026-01-0)";
  const auto cut = read_history(path);
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().text.find("the last line of the rig's history is cut off"), std::string::npos) << cut.error().to_text();
  EXPECT_NE(cut.error().hint.find("remove line 2"), std::string::npos) << cut.error().to_text();
  std::ofstream(path) << R"({"format":1,"date":"2026-01-01","values":{"noise":0.1}})";
  ASSERT_TRUE(append_visit(path, {"2026-01-02", "r", "f", "ACCEPT", {{"noise", 0.1}}}));
  const auto both = read_history(path);
  ASSERT_TRUE(both) << both.error().to_text();
  EXPECT_EQ(both->size(), 2U) << "the first line had no end";
  std::filesystem::remove(path);
  const auto device = read_history("/dev/full");
  ASSERT_FALSE(device);
  EXPECT_NE(device.error().text.find("this is none"), std::string::npos) << device.error().to_text();
}

TEST(RigHistory, keeps_every_visit_and_charts_only_those_of_the_same_rig) {
  const auto path = std::filesystem::temp_directory_path() / "forcegate_rig_history_test.jsonl";
  std::filesystem::remove(path);
  for (int i = 0; i < 12; ++i) {
    RigVisit v{"2026-11-21T08:00:00Z",
               i % 2 ? "bench A" : "bench B",
               "abc",
               "ACCEPT",
               {{"rig_reference_zero", 0.001 * i}}};
    ASSERT_TRUE(append_visit(path, v));
  }
  const auto history = read_history(path);
  ASSERT_TRUE(history);
  ASSERT_EQ(history->size(), 12u);
  const auto charts = control_charts(*history);
  ASSERT_EQ(charts.size(), 1u);
  EXPECT_EQ(charts[0].x.size(), 6u);
  std::ofstream(path, std::ios::app) << "not a visit\n";
  const auto damaged = read_history(path);
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().where.find(":13"), std::string::npos);
  std::filesystem::remove(path);
}

class ChartedVisits : public ::testing::Test {
 protected:
  void visit(double value, const std::string& decision = "ACCEPT", const std::string& build = "abc") {
    history_.push_back({"2026-11-21T08:00:00Z", "bench", build, decision, {{"noise", value}}});
  }
  ControlChart chart() const { return control_charts(history_).at(0); }
  std::vector<RigVisit> history_;
};

TEST_F(ChartedVisits, a_visit_that_gave_no_decision_is_judged_and_judges_no_other) {
  const std::vector<double> x = steady(25);
  for (std::size_t i = 0; i < 10; ++i) visit(x[i]);
  visit(0.5, "NO-DECISION");
  EXPECT_FALSE(chart().in_control);
  for (std::size_t i = 10; i < x.size(); ++i) {
    visit(x[i]);
    const ControlChart without = control_chart("noise", {x.begin(), x.begin() + static_cast<std::ptrdiff_t>(i) + 1}, 1e-6);
    EXPECT_EQ(chart().text, without.text) << "visit " << i;
    EXPECT_EQ(chart().ewma, without.ewma);
  }
}

TEST_F(ChartedVisits, one_before_the_baseline_is_no_part_of_it) {
  const std::vector<double> x = steady(12);
  visit(0.5, "REJECT");
  for (const double value : x) visit(value);
  EXPECT_NEAR(chart().centre, 0.010, 0.001);
  visit(0.030);
  EXPECT_FALSE(chart().in_control);
}

TEST_F(ChartedVisits, another_build_begins_a_chart_of_its_own) {
  for (const double value : steady(12)) visit(value);
  visit(0.5, "ACCEPT", "def");
  EXPECT_TRUE(chart().in_control) << "what changed is the build: " << chart().text;
  EXPECT_FALSE(chart().enough);
  visit(0.010);
  EXPECT_TRUE(chart().in_control) << chart().text;
  EXPECT_EQ(charted_visits(history_).size(), 13U);
}

TEST(GaugeShare, a_rig_that_scatters_by_a_tenth_of_the_limit_is_at_the_edge) {
  EXPECT_NEAR(gauge_share_pct(0.45, 4.5), kGaugeRefused_pct, 1e-9);
  EXPECT_GT(gauge_share_pct(1.0, 4.5), kGaugeRefused_pct);
  EXPECT_TRUE(std::isinf(gauge_share_pct(1.0, 0.0)));
}

}  // namespace
}  // namespace forcegate
