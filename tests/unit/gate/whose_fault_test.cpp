// Who is asked to act where neither the firmware nor its values are at fault.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/calibrate.h"
#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::find;

TEST(WhoseFault, a_calibration_that_is_cut_short_is_the_links_and_is_made_again) {
  Bench s;
  s.rig.ends_after_s = 40.0;
  s.job.kind = CaseJob::Kind::calibration;
  s.job.calibrate.level = CalibrationLevel::statical;
  const CaseRecord record = run_calibration(s.job, s.rig);
  ASSERT_TRUE(record.failure);
  EXPECT_EQ(record.failure->stage, CaseFailure::Stage::rig) << record.failure->error.text;
  const JudgedCase judged = s.judge(record);
  EXPECT_EQ(find(judged, "rig_runs")->verdict, Verdict::rig_error);
  EXPECT_EQ(find(judged, "rig_runs")->blame, Blame::link);
}

// An ATI on a wire gives no value in overload, the emulated one its last: whose the overload is does not hang on that.
TEST(WhoseFault, an_overload_is_the_builds_that_drove_the_loop_there_and_else_the_references_with_a_value_or_without) {
  for (const bool with_value : {true, false})
    for (const bool driven : {true, false}) {
      Bench s;
      s.close_loop();
      s.job.safety.force_max_N = s.plan.safety.force_max_N = 4.0;
      s.rig.spoil = [=](std::size_t row, double t_s, RigBlock& b) {
        if (driven ? b.force_ref_N[row] < 3.7f : !(t_s > 25.0 && t_s < 25.1)) return;
        b.status[row] |= kRigReferenceSaturated;
        if (!with_value) b.force_ref_N[row] = std::nanf("");
      };
      if (driven)
        s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t&) {
          if (index > 20000) force_N = 0.5f;
        };
      const JudgedCase judged = s.judge(s.run());
      const Check& valid = *find(judged, "rig_reference_valid");
      EXPECT_EQ(valid.verdict, driven ? Verdict::pass : Verdict::rig_error) << with_value << driven << valid.evidence;
      EXPECT_EQ(valid.evidence.find("the build drove the force there") != std::string::npos, driven) << with_value << valid.evidence;
    }
}

// The limits of another rig were derived with another reference.
TEST(WhoseFault, limits_of_another_rig_leave_the_whole_uncertainty) {
  Bench s;
  s.job.planned.maxima_pct = s.job.planned.minima_pct = std::nullopt;
  const CaseRecord record = s.run();
  DerivedLimits limits;
  limits.by_case_and_check[{"sine", "mre_maxima"}] = limits.by_case_and_check[{"sine", "mre_minima"}] = {4.0, 0.5, 5.0, "%", 300};
  const auto u = [&](const std::string& rig) {
    limits.rig = rig;
    return find(judge_case(s.plan, s.job.planned, record, limits), "mre_maxima")->u;
  };
  const double same = u(record.rig.name + "/" + record.rig.version);
  EXPECT_EQ(u(record.rig.name + "/" + record.rig.version + " " + record.rig.id), same);
  EXPECT_GT(u("bench/9"), same + 0.1) << "calibration and alignment of the ATI do not cancel";
}

// Minima below half a newton, or a profile that ends in the start window: the plan asks for what it has not.
TEST(WhoseFault, a_promise_that_the_profile_cannot_give_is_the_plans_and_no_percentage) {
  Bench s;
  s.close_loop();
  s.job.planned.checks = kCheckPromise;
  for (const double mean_N : {1.25, 2.0}) {
    s.job.planned.stimulus.numbers["m_N"] = mean_N;
    JudgedCase judged = s.judge(s.run());
    if (mean_N < 2.0)
      EXPECT_EQ(judged.minima.unit, "N");
    else
      judged.maxima.usable = judged.minima.usable = false;  // no extremum behind the window
    const auto checks = judge_panel(s.plan, s.job.planned, {{"fake", {&judged}}});
    ASSERT_EQ(checks.size(), 2U);
    EXPECT_TRUE(std::isnan(checks[1].check.value)) << mean_N;
    EXPECT_EQ(checks[1].check.verdict, Verdict::inconclusive);
    EXPECT_EQ(checks[1].check.blame, Blame::user) << mean_N;
  }
}

class RateComparator final : public Comparator {
 public:
  Result<void> begin(const ComparatorSession&) override { return fail(ErrorCode::config, "the algorithm is defined at 1000 Hz"); }
  void push(std::span<const std::uint16_t>, std::span<const float>, std::span<const std::uint8_t>) override {}
  Comparison finish() override { return {}; }
};

TEST(WhoseFault, an_algorithm_that_the_image_cannot_run_at_its_rate_is_a_wrong_declaration_and_no_defect_of_ours) {
  Bench s;
  RateComparator comparator;
  RunDevices devices;
  devices.rig = &s.rig;
  devices.dut = &s.dut;
  devices.comparator = &comparator;
  const JudgedCase judged = s.judge(run_case(s.job, devices));
  EXPECT_FALSE(judged.harness_error);
  EXPECT_EQ(find(judged, "firmware_runs")->blame, Blame::firmware);
}

}  // namespace
}  // namespace forcegate
