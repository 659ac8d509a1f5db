#include "hil/characterize/capacitance/weight_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/characterize/capacitance/weight_summary.h"

namespace forcegate::test {
namespace {

using namespace characterize;

WeightPlan small_plan() {
  WeightPlan p;
  p.sets = 2;
  p.most_training = 3;
  p.testing = 2;
  p.dc_samples = 800;
  p.sine_samples = 800;
  p.step_N = 10.0;
  p.sweep_samples = 3200;
  p.sweep_points = 40;
  return p;
}

Result<WeightStudy> run(const WeightPlan& plan, unsigned threads) {
  return run_weight_study({plan, [] { return make_weight_bench("dead_weight", {}); }, threads, {}, nullptr});
}

TEST(WeightStudy, answer_does_not_depend_on_the_number_of_threads_and_the_models_are_tested_on_new_loadings) {
  const auto one = run(small_plan(), 1), two = run(small_plan(), 2);
  ASSERT_TRUE(one.has_value()) << one.error().to_text();
  ASSERT_EQ(one->sets.size(), 2u);
  ASSERT_EQ(one->exemplar.size(), 8u);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t s = 0; s < 8; ++s) {
      EXPECT_EQ(one->sets[i].sensors[s].mse_N2, two->sets[i].sensors[s].mse_N2);
      EXPECT_EQ(one->sets[i].sensors[s].tested, 2u * 25u);
      EXPECT_EQ(one->sets[i].sensors[s].network_mse_N2.size(), 3u);
      for (const SweepResult& w : one->sets[i].sensors[s].sweeps) {
        ASSERT_TRUE(w.fitted);
        EXPECT_NEAR(w.fit.conductance_S, w.true_conductance_S, 6.0 * w.fit.u_conductance_S);
        EXPECT_NEAR(w.fit.capacitance_F, w.true_capacitance_F, 6.0 * w.fit.u_capacitance_F);
        EXPECT_NEAR(w.fit.divergence_Hz, w.true_divergence_Hz, 6.0 * w.fit.u_divergence_Hz);
      }
    }
  EXPECT_NE(one->sets[0].sensors[0].mse_N2, one->sets[1].sensors[0].mse_N2);
}

TEST(WeightStudy, says_when_the_amplifier_saturates) {
  WeightPlan plan = small_plan();
  plan.sine_V = 12.0;
  const auto study = run(plan, 1);
  ASSERT_FALSE(study.has_value());
  EXPECT_NE(study.error().text.find("saturates"), std::string::npos);
}

TEST(WeightStudy, what_no_sweep_gave_is_not_measured) {
  WeightPlan plan = small_plan();
  plan.sweep_V = 50.0;
  const auto study = run(plan, 1);
  ASSERT_TRUE(study.has_value()) << study.error().to_text();
  bool told = false;
  for (const WeightClaim& c : claims_of(*study, summarise(*study))) {
    EXPECT_EQ(c.ours.find("nan"), std::string::npos) << c.subject << ": " << c.ours;
    told = told || (c.ours == "not measured" && c.has_window && !c.inside);
  }
  EXPECT_TRUE(told);
}

TEST(WeightPlan, the_committed_one_is_good_and_mistakes_are_named_with_their_place) {
  const auto plan = read_weight_plan(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance.toml");
  ASSERT_TRUE(plan.has_value()) << plan.error().to_text();
  EXPECT_GE(plan->sets, 30u);
  EXPECT_EQ(plan_kind(FORCEGATE_SOURCE_DIR "/ci/plans/capacitance.toml").value_or(""), "capacitance");
  EXPECT_EQ(plan_kind(FORCEGATE_SOURCE_DIR "/ci/plans/tms.toml").value_or(""), "characterize");
  const std::string head = "format = 1\nkind = \"capacitance\"\nname = \"x\"\n";
  for (const char* bad :
       {"[loading]\ntraning = 3\n", "[loading]\ntraining = 1\n", "[sweep]\nforces_N = [300.0]\n",
        "[source]\ndc_V = 0.0\n", "[loading]\ntraining = 5\nmost_training = 4\n",
        "[sweep]\nlow_Hz = 100.0\nhigh_Hz = 100000.0\npoints = 12\n"}) {
    const auto read = parse_weight_plan(head + bad, "p.toml");
    ASSERT_FALSE(read.has_value()) << bad;
    EXPECT_NE(read.error().where.find("p.toml:"), std::string::npos) << bad;
  }
}

}  // namespace
}  // namespace forcegate::test
