// What a rig's own checks let pass is not charged to the firmware.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/gate/sinks.h"
#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::find;

// The firmware passes on what the sensor gives; its gain is the calibrated one times `gain`.
JudgedCase with_another_specimen(double gain) {
  Bench bench;
  bench.job.calibration.level = CalibrationLevel::statical;
  CaseRecord record = bench.run();
  const double offset_N = record.calibration.offset_N;
  const auto scaled = [&](double force_N) { return offset_N + gain * (force_N - offset_N); };
  for (CasePair& p : record.pairs) p.raw_N = scaled(p.raw_N), p.dut_N = scaled(p.dut_N);
  record.early_raw_N = scaled(record.early_raw_N);
  return bench.judge(record);
}

TEST(RigShare, a_specimen_that_is_not_the_calibrated_one_rejects_no_build) {
  for (const double gain : {0.6, 0.75, 0.85, 0.9, 0.92, 0.94, 0.96, 1.04, 1.06, 1.08, 1.1, 1.15, 1.25, 1.4}) {
    const JudgedCase judged = with_another_specimen(gain);
    for (const JudgedCheck& j : judged.checks) EXPECT_NE(j.check.verdict, Verdict::fail) << gain << " " << j.check.id;
    const Check* fits = find(judged, "rig_calibration_fits");
    ASSERT_NE(fits, nullptr);
    if (gain >= 1.1 || gain <= 0.75) {
      EXPECT_EQ(fits->verdict, Verdict::rig_error) << gain;
      EXPECT_EQ(fits->blame, Blame::calibration);
    }
  }
}

TEST(RigShare, a_sensor_that_fits_its_calibration_excuses_no_gain_of_the_firmware) {
  for (const double gain : {0.88, 1.12}) {
    Bench bench;
    CaseRecord record = bench.run();
    for (CasePair& p : record.pairs) p.dut_N *= gain;
    const JudgedCase judged = bench.judge(record);
    EXPECT_EQ(find(judged, "mre_maxima")->verdict, Verdict::fail) << gain;
    EXPECT_EQ(find(judged, "mre_maxima")->blame, Blame::firmware);
  }
}

TEST(RigShare, a_sensor_that_reads_low_at_first_excuses_no_output_that_is_too_high) {
  Bench bench;
  bench.job.calibration.level = CalibrationLevel::statical;
  CaseRecord record = bench.run();
  record.early_raw_N *= 0.9;
  for (CasePair& p : record.pairs) p.raw_N *= 0.94;
  const CaseRecord sound = record;
  for (CasePair& p : record.pairs) p.dut_N *= 1.14;
  EXPECT_EQ(find(bench.judge(record), "mre_minima")->verdict, Verdict::fail);
  record = sound;
  for (CasePair& p : record.pairs) p.dut_N *= 0.9;
  EXPECT_EQ(find(bench.judge(record), "mre_minima")->verdict, Verdict::inconclusive);
}

TEST(RigShare, nothing_passes_by_what_a_calibration_may_explain) {
  Check c;
  c.value = 6.0;
  c.u = 0.1;
  c.unit = "%";
  c.limit = {Limit::Kind::upper, 5.0, "test"};
  JudgedCheck j{c};
  j.explained = 50.0;
  std::vector<JudgedCheck*> all{&j};
  for (int again = 0; again < 2; ++again) {
    apply_rule({}, all);
    EXPECT_EQ(j.check.verdict, Verdict::inconclusive);
    EXPECT_EQ(j.check.blame, Blame::calibration);
  }
  const std::string once = j.check.evidence;
  apply_rule({}, all);
  EXPECT_EQ(j.check.evidence, once);
}

Check lag(double lag_s, double codes_s) {
  Bench bench;
  CaseRecord record = bench.run();
  record.lag_s = lag_s;
  record.u_lag_s = 1e-4;
  record.raw_lag_s = codes_s;
  const auto checks = bench.judge(record);
  const Check* c = find(checks, "lag");
  return c == nullptr ? Check{} : *c;
}

TEST(RigShare, the_link_s_delay_is_not_the_firmware_s_lag) {
  EXPECT_EQ(lag(0.055, 0.0255).verdict, Verdict::inconclusive);
  EXPECT_EQ(lag(0.055, 0.0255).blame, Blame::link);
  EXPECT_EQ(lag(0.080, 0.0255).verdict, Verdict::fail);
  EXPECT_EQ(lag(0.080, 0.0255).blame, Blame::firmware);
  EXPECT_EQ(lag(0.055, 0.0).verdict, Verdict::fail);
  EXPECT_EQ(lag(0.030, 0.0255).verdict, Verdict::pass);
}

TEST(RigShare, a_late_ati_hides_no_lag_of_the_firmware) {
  EXPECT_EQ(lag(0.045, -0.009).verdict, Verdict::inconclusive);
  EXPECT_EQ(lag(0.045, -0.009).blame, Blame::reference);
  EXPECT_EQ(lag(0.035, -0.009).verdict, Verdict::pass);
}

// `spoil` changes firmware and code of the row; 20 s in blocks as odd as a closed loop's.
double spike_N(const std::function<void(std::size_t row, float& dut_N, float& raw_N)>& spoil, double rate_Hz = 1000.0) {
  OutputWatch watch;
  watch.begin(rate_Hz, 0.0);
  RigBlock block;
  block.resize(7);
  std::vector<float> dut(7), raw(7);
  const std::vector<std::uint8_t> flags(7, 0);
  for (std::size_t row = 0; row + 7 <= 20000; row += 7) {
    for (std::size_t i = 0; i < 7; ++i) {
      const double t_s = static_cast<double>(row + i) / rate_Hz;
      block.t_s[i] = t_s;
      block.status[i] = 0;
      block.force_ref_N[i] = raw[i] = dut[i] = static_cast<float>(2.7 + 1.5 * std::sin(6.2832 * 3.0 * t_s));
      spoil(row + i, dut[i], raw[i]);
    }
    watch.push({&block, dut, flags, raw, 7});
  }
  return watch.finish().spike_N;
}

TEST(OutputSpike, one_sample_is_seen_and_the_turn_of_a_fast_force_is_none) {
  EXPECT_LT(spike_N([](std::size_t, float&, float&) {}), 0.05);
  EXPECT_GT(spike_N([](std::size_t row, float& dut, float&) { if (row == 9001) dut = 10.0f; }), 4.0);
  EXPECT_GT(spike_N([](std::size_t row, float& dut, float&) { if (row == 9001) dut = -10.0f; }), 9.0);
  EXPECT_GT(spike_N([](std::size_t row, float& dut, float&) { if (row == 9001) dut = 0.0f; }), 0.8);
  EXPECT_GT(spike_N([](std::size_t row, float& dut, float&) { if (row > 9000 && row < 9009) dut = 10.0f; }), 4.0);
}

TEST(OutputSpike, the_sensor_s_own_spike_and_a_step_are_none_of_the_firmware_s) {
  EXPECT_LT(spike_N([](std::size_t row, float& dut, float& raw) {
    if (row == 9001) raw += 3.0f;
    if (row == 9011) dut += 3.0f;
  }), 0.05);
  EXPECT_LT(spike_N([](std::size_t row, float& dut, float&) { if (row > 9000) dut += 1.0f; }), 0.1);
  EXPECT_TRUE(std::isnan(spike_N([](std::size_t, float&, float&) {}, 100.0)));
}

TEST(OutputSpike, is_judged_against_the_plan) {
  Bench bench;
  CaseRecord record = bench.run();
  EXPECT_EQ(find(bench.judge(record), "output_spike")->verdict, Verdict::pass);
  record.output.spike_N = 0.6;
  EXPECT_EQ(find(bench.judge(record), "output_spike")->verdict, Verdict::fail);
  bench.plan.limits.spike_max_N = 1.0;
  EXPECT_EQ(find(bench.judge(record), "output_spike")->verdict, Verdict::pass);
}

}  // namespace
}  // namespace forcegate
