// What part of a record is judged, and on how much of it an accuracy stands.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/budget.h"
#include "hil/gate/calibrate.h"
#include "hil/gate/run_judge.h"
#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::find;

TEST(JudgedPart, a_start_window_that_comes_late_is_as_long_as_what_it_takes_out_of_judgement) {
  Bench s;
  s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t& flags) {
    if (index < 40000) force_N *= 0.5f;
    if (index >= 40000 && index < 41000) flags |= kDutLearning;
  };
  const JudgedCase judged = s.judge(s.run());
  const Check* window = find(judged, "learning_window");
  ASSERT_NE(window, nullptr);
  EXPECT_NEAR(window->value, 41.0 - s.run().facts.excitation_start_s, 0.01);
  EXPECT_EQ(window->verdict, Verdict::fail);
}

TEST(JudgedPart, one_extremum_of_a_kind_is_no_accuracy) {
  Bench s;
  s.job.planned.stimulus.numbers["duration_s"] = 20.0;
  CaseRecord r = s.run();
  r.output.learning_end_s = 18.2;  // one maximum is behind it
  s.plan.limits.learning_s = 17.0;
  const JudgedCase judged = s.judge(r);
  EXPECT_EQ(find(judged, "mre_maxima")->verdict, Verdict::not_run) << find(judged, "mre_maxima")->evidence;
  EXPECT_NE(find(judged, "mre_maxima")->evidence.find("play a longer profile"), std::string::npos);
}

TEST(JudgedPart, few_extrema_are_covered_by_students_factor) {
  CaseRecord r;
  r.rig.reference_u_rel = 0.0;
  const Budget few = mre_budget({}, r, 3.0, 0.01, 3, 0.005);
  EXPECT_NEAR(few.degrees_of_freedom(few.u(), 3), 2.0 * std::pow(few.u(), 4), 1e-9);  // u_repeatability is 1 %
  EXPECT_EQ(mre_budget({}, r, 3.0, std::nan(""), 3, 0.005).degrees_of_freedom(0.1, 3), 0.0);
  Bench s;
  s.job.planned.stimulus.numbers["duration_s"] = 20.0;
  CaseRecord short_one = s.run();
  int k = 0;
  for (CasePair& p : short_one.pairs) p.dut_N *= 1.0 + 0.01 * (k++ % 3);
  short_one.output.learning_end_s = 14.0;
  for (const JudgedCheck& j : s.judge(short_one).checks)
    if (j.check.id == "mre_maxima") {
      EXPECT_GT(j.dof, 0.5);
      EXPECT_LT(j.dof, 20.0);
      EXPECT_GT(j.check.expanded_u, 2.1 * j.check.u);
    }
}

TEST(JudgedPart, extrema_that_the_reference_does_not_show_are_missing) {
  Bench s;
  CaseRecord r = s.run();
  EXPECT_EQ(find(s.judge(r), "extrema_count")->verdict, Verdict::pass) << find(s.judge(r), "extrema_count")->evidence;
  const double stuck_N = r.pairs[r.pairs.size() / 2].ati_N;
  for (std::size_t i = r.pairs.size() / 2; i < r.pairs.size(); ++i) r.pairs[i].ati_N = stuck_N;
  const JudgedCase judged = s.judge(r);
  EXPECT_NE(find(judged, "extrema_count")->verdict, Verdict::pass) << find(judged, "extrema_count")->evidence;
  EXPECT_NE(find(judged, "mre_maxima")->verdict, Verdict::fail) << "nobody is judged on a wheel that stood still";
}

TEST(JudgedPart, synchronisation_is_of_the_swing_that_is_judged) {
  CaseRecord r;
  r.u_lag_s = 0.006;
  r.facts.lowest_frequency_Hz = 0.05;
  for (int i = 0; i < 60; ++i) r.pairs.push_back({i % 2 == 0, i / 6.0, 2.0, 2.0, 2.0, 2.0});  // 3 Hz
  const auto part = [&] {
    for (const BudgetLine& line : mre_budget({}, r, 3.0, 0.001, 100, 0.005).lines)
      if (line.name == "synchronisation") return line.u;
    return std::nan("");
  };
  EXPECT_NEAR(part(), 100.0 * (1.0 - std::cos(2.0 * 3.14159265 * 3.0 * 0.006)), 1e-3);
}

TEST(JudgedPart, a_calibration_that_no_image_takes_is_the_sensors) {
  Bench s;
  s.rig.gain_N_per_V = 105.0;
  s.job.calibrate.sweep_high_N = 4.9;
  s.job.kind = CaseJob::Kind::calibration;
  s.job.specimen = "fake";
  s.job.calibrate.level = CalibrationLevel::statical;
  const CaseRecord r = run_calibration(s.job, s.rig);
  ASSERT_TRUE(r.failure);
  EXPECT_EQ(r.failure->stage, CaseFailure::Stage::rig);
  EXPECT_EQ(r.failure->blame, Blame::sensor);
  EXPECT_NE(r.failure->error.text.find("G = 105"), std::string::npos) << r.failure->error.text;
  Calibration c;
  EXPECT_EQ(beyond_what_images_take(c), "");
  c.q_scale = 153.0;
  EXPECT_NE(beyond_what_images_take(c), "");
  c.q_scale = std::nan("");
  EXPECT_NE(beyond_what_images_take(c), "");
}

TEST(JudgedPart, the_window_around_the_worst_maximum_has_that_maximum_in_it) {
  for (const double f_Hz : {0.5, 2.0, 4.0})
    for (const std::uint32_t at : {9000u, 24600u, 31300u, 59400u}) {
      Bench s;
      s.job.planned.stimulus.numbers["f_Hz"] = f_Hz;
      s.dut.spoil = [=](std::uint32_t index, float& force_N, std::uint8_t&) {
        if (index > at - 500 && index < at + 500) force_N *= 1.5f;
      };
      const CaseRecord r = s.run();
      ASSERT_EQ(r.window_reason.rfind("worst maximum, at ", 0), 0u) << r.window_reason;
      const double t_s = std::stod(r.window_reason.substr(18));
      ASSERT_NEAR(t_s, 1e-3 * at, 0.6);
      ASSERT_FALSE(r.window.empty());
      EXPECT_LT(r.window.front().t_s.front(), t_s) << f_Hz << " Hz";
      EXPECT_GT(r.window.front().t_s.back(), t_s) << f_Hz << " Hz";
      EXPECT_NEAR(r.window.front().t_s.back() - r.window.front().t_s.front(), std::max(2.0, 5.0 / f_Hz), 0.02);
    }
}

TEST(JudgedPart, an_attempt_that_the_rig_spoiled_is_told_from_a_record_that_failed) {
  Bench s;
  RunMaterial m;
  m.plan = s.plan;
  m.plan.panel = {"fake"};
  m.plan.cases = {s.job.planned};
  for (int attempt = 1; attempt <= 2; ++attempt) {
    PlayedRecord& one = m.records.emplace_back();
    one.job = s.job;
    one.job.attempt = attempt;
    one.record = s.run();
    one.superseded = attempt == 1;
  }
  const RunResult result = to_run_result(m, judge_material(m));
  ASSERT_EQ(result.cases.size(), 2u);
  EXPECT_TRUE(is_superseded(result.cases[0]));
  EXPECT_FALSE(result.cases[0].note.empty());
  EXPECT_FALSE(is_superseded(result.cases[1]));
}

}  // namespace
}  // namespace forcegate
