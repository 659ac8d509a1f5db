#include "hil/gate/runner.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/gate/blame.h"
#include "hil/gate/calibrate.h"
#include "hil/gate/case_json.h"
#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;
using testing::find;

bool all_required_pass(const JudgedCase& judged) {
  for (const JudgedCheck& j : judged.checks)
    if (j.check.required && j.check.verdict != Verdict::pass) {
      ADD_FAILURE() << j.check.id << " " << to_string(j.check.verdict) << " " << j.check.evidence;
      return false;
    }
  return true;
}

TEST(Runner, charges_another_rate_to_the_firmware_only_where_nobody_gave_the_rate) {
  Bench s;
  s.dut.only_rate_Hz = 500.0;
  const CaseRecord own = s.run();
  ASSERT_TRUE(own.failure);
  EXPECT_EQ(own.failure->stage, CaseFailure::Stage::firmware);
  EXPECT_EQ(own.failure->error.code, ErrorCode::firmware);
  s.job.rig_options["rate_Hz"] = "1000";
  const CaseRecord given = s.run();
  ASSERT_TRUE(given.failure);
  EXPECT_EQ(given.failure->stage, CaseFailure::Stage::setup);
  EXPECT_EQ(given.failure->error.code, ErrorCode::config);
}

TEST(Runner, finds_no_error_in_an_exact_sensor) {
  Bench s;
  const CaseRecord r = s.run();
  ASSERT_FALSE(r.failure) << r.failure->error.to_text();
  EXPECT_EQ(r.samples, 60000u);
  EXPECT_EQ(r.expected_extrema, 57u);
  EXPECT_NEAR(r.lag_s, 0.0, 1e-4);
  const JudgedCase judged = s.judge(r);
  EXPECT_TRUE(all_required_pass(judged));
  EXPECT_LT(find(judged, "mre_maxima")->value, 0.01);
}

TEST(Runner, measures_a_gain_error_as_the_mean_relative_error) {
  Bench s;
  s.dut.spoil = [](std::uint32_t, float& force_N, std::uint8_t&) { force_N *= 1.08f; };
  const JudgedCase judged = s.judge(s.run());
  EXPECT_NEAR(find(judged, "mre_maxima")->value, 8.0, 0.05);
  EXPECT_EQ(find(judged, "mre_maxima")->verdict, Verdict::fail);
  EXPECT_EQ(find(judged, "mre_maxima")->blame, Blame::firmware);
}

TEST(Runner, measures_a_lag_in_either_direction_of_the_force) {
  Bench s;
  std::vector<float> line(30, 0.0f);
  s.dut.spoil = [&](std::uint32_t index, float& force_N, std::uint8_t&) {
    std::swap(force_N, line[index % 30]);
  };
  const CaseRecord r = s.run();
  EXPECT_NEAR(r.lag_s, 0.030, 0.001);
}

TEST(Runner, only_what_is_held_against_a_derived_limit_leaves_out_what_that_limit_holds) {
  testing::Bench b;
  b.job.planned.maxima_pct = b.job.planned.minima_pct = std::nullopt;
  DerivedLimits limits;
  for (const char* id : {"mre_maxima", "mre_minima"}) limits.by_case_and_check[{"sine", id}].value = 5.0;
  const CaseRecord record = b.run();
  const JudgedCase judged = judge_case(b.plan, b.job.planned, record, limits);
  const Check *relative = find(judged, "mre_maxima"), *absolute = find(judged, "mae_maxima");
  const double calibration_N = record.rig.reference_u_rel * 3.0;
  ASSERT_GT(calibration_N, 0.0);
  EXPECT_GE(absolute->u, calibration_N) << "nothing is judged on it";
  EXPECT_LT(relative->u / 100.0, record.rig.reference_u_rel);
  EXPECT_NE(relative->evidence.find("without ATI calibration"), std::string::npos) << relative->evidence;
  EXPECT_EQ(absolute->evidence.find("without"), std::string::npos) << absolute->evidence;
}

TEST(Runner, a_lag_that_whole_periods_may_hide_is_not_decided) {
  testing::Bench b;
  b.job.planned.stimulus.numbers["f_Hz"] = 10.0;
  b.job.planned.stimulus.numbers["A_N"] = 0.5;
  b.job.planned.maxima_pct = b.job.planned.minima_pct = 90.0;
  const CaseRecord record = b.run();
  const JudgedCase judged = b.judge(record);
  const Check* lag = find(judged, "lag");
  ASSERT_NE(lag, nullptr);
  EXPECT_EQ(lag->verdict, Verdict::inconclusive) << lag->evidence;
  EXPECT_EQ(lag->blame, Blame::user);
  EXPECT_NE(lag->evidence.find("whole periods of 100 ms"), std::string::npos) << lag->evidence;
  b.plan.limits.lag_s = 0.02;
  EXPECT_EQ(find(b.judge(record), "lag")->verdict, Verdict::pass);
}

TEST(Runner, a_lag_that_cannot_be_told_stays_in_the_list) {
  testing::Bench b;
  CaseRecord record = b.run();
  ASSERT_EQ(find(b.judge(record), "lag")->verdict, Verdict::pass);
  record.lag_s = record.u_lag_s = std::nan("");
  const JudgedCase judged = b.judge(record);
  ASSERT_NE(find(judged, "lag"), nullptr);
  EXPECT_EQ(find(judged, "lag")->verdict, Verdict::inconclusive);
}

const Registration<ComparatorKind> kOracle{{"test", "for tests", [](std::string_view id) { return id == "known/1"; }, [] { return std::unique_ptr<Comparator>(); }, {"known/1"}}};

TEST(Runner, a_conformance_that_is_asked_for_and_cannot_run_is_owed) {
  testing::Bench b;
  b.job.planned.checks |= kCheckConformance;
  CaseRecord record = b.run();
  const auto conformance = [&](const std::string& id) {
    record.firmware.algorithm_id = id;
    const JudgedCase judged = b.judge(record);
    const Check* c = find(judged, "conformance");
    EXPECT_NE(c, nullptr) << id;
    return c == nullptr ? Check{} : *c;
  };
  for (const char* slip : {"knwn/1", "known/2", "Known/1", ""}) {
    const Check c = conformance(slip);
    EXPECT_EQ(c.verdict, Verdict::not_run) << slip;
    EXPECT_TRUE(c.required) << slip;
    EXPECT_EQ(c.blame, Blame::firmware) << slip;
  }
  EXPECT_NE(conformance("knwn/1").evidence.find("is 'known/1' meant?"), std::string::npos);
  for (const char* own : {"known/1+creep", "own-filter/3"}) EXPECT_FALSE(conformance(own).required) << own << ": its values are judged";
  b.job.planned.checks = kCheckConformance;
  for (const char* own : {"known/1+creep", "own-filter/3"}) {
    EXPECT_TRUE(conformance(own).required) << own << ": nothing else judges a value";
    EXPECT_EQ(conformance(own).blame, Blame::user);
  }
  b.plan.cases.push_back(b.job.planned);
  b.plan.cases.back().checks = kCheckPromise;
  EXPECT_FALSE(conformance("own-filter/3").required) << "another case does";
}

TEST(Runner, closes_the_loop_over_the_firmware_s_estimate) {
  Bench s;
  s.close_loop();
  const CaseRecord r = s.run();
  ASSERT_FALSE(r.failure);
  const JudgedCase judged = s.judge(r);
  ASSERT_TRUE(judged.maxima.usable);
  EXPECT_LT(judged.maxima.value, 3.0);
}

TEST(Runner, a_low_estimate_drives_the_closed_loop_too_high_by_as_much) {
  Bench s;
  s.close_loop();
  s.dut.spoil = [](std::uint32_t, float& force_N, std::uint8_t&) { force_N *= 0.9f; };
  const JudgedCase judged = s.judge(s.run());
  EXPECT_NEAR(judged.maxima.value, 10.0, 2.5);
}

TEST(Runner, is_the_same_to_the_last_bit_when_repeated) {
  Bench a, b;
  const CaseRecord first = a.run(), second = b.run();
  EXPECT_EQ(first.digest, second.digest);
  EXPECT_EQ(to_json(first), to_json(second));
}

TEST(Runner, one_changed_sample_changes_the_digest) {
  Bench a, b;
  b.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t&) {
    if (index == 31234) force_N = std::nextafter(force_N, 10.0f);
  };
  EXPECT_NE(a.run().digest, b.run().digest);
}

TEST(Runner, refuses_output_that_does_not_echo_the_nonce) {
  Bench s;
  s.dut.wrong_nonce = true;
  const CaseRecord r = s.run();
  ASSERT_TRUE(r.failure);
  EXPECT_EQ(find(s.judge(r), "firmware_runs")->verdict, Verdict::fail);
}

TEST(Runner, charges_a_firmware_that_stops_answering) {
  Bench s;
  s.dut.dies_at = 20000;
  const JudgedCase judged = s.judge(s.run());
  EXPECT_EQ(find(judged, "firmware_runs")->blame, Blame::firmware);
}

TEST(Runner, one_nan_fails_the_build_and_says_when) {
  Bench s;
  s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t&) {
    if (index == 40000) force_N = std::nanf("");
  };
  const JudgedCase judged = s.judge(s.run());
  const Check* c = find(judged, "output_finite");
  EXPECT_EQ(c->verdict, Verdict::fail);
  EXPECT_NE(c->evidence.find("40.000 s"), std::string::npos) << c->evidence;
}

TEST(Runner, a_truncated_record_decides_nothing) {
  Bench s;
  s.rig.ends_after_s = 40.0;
  const JudgedCase judged = s.judge(s.run());
  EXPECT_EQ(find(judged, "coverage")->verdict, Verdict::rig_error) << "played again it may be whole";
  EXPECT_EQ(find(judged, "coverage")->blame, Blame::link);
  EXPECT_EQ(find(judged, "mre_maxima")->verdict, Verdict::inconclusive);
  CaseRecord recorded = s.run();
  recorded.rig.can_move = false;
  EXPECT_EQ(find(s.judge(recorded), "coverage")->verdict, Verdict::inconclusive) << "a recording is the same the next time";
  s.dut.spoil = [](std::uint32_t i, float& force_N, std::uint8_t&) { force_N = i == 20000 ? std::nanf("") : force_N; };
  EXPECT_EQ(find(s.judge(s.run()), "output_finite")->verdict, Verdict::fail) << "what the firmware did stays wrong";
}

TEST(Runner, an_unsound_reference_takes_the_record_out_of_judgement) {
  Bench s;
  s.rig.spoil = [](std::size_t row, double t_s, RigBlock& b) {
    if (t_s > 20.0 && b.force_ref_N[row] > 2.5f) b.status[row] |= kRigReferenceSaturated;
  };
  s.dut.spoil = [](std::uint32_t, float& force_N, std::uint8_t&) { force_N *= 2.0f; };
  const JudgedCase judged = s.judge(s.run());
  EXPECT_EQ(find(judged, "mre_maxima")->verdict, Verdict::rig_error);
  EXPECT_EQ(find(judged, "rig_reference_valid")->blame, Blame::reference);
  for (const JudgedCheck& j : judged.checks) EXPECT_NE(j.check.verdict, Verdict::fail) << j.check.id;
}

TEST(Runner, charges_a_build_that_drives_the_loop_into_the_force_limit) {
  Bench s;
  s.close_loop();
  s.job.safety.force_max_N = 4.0;
  s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t&) {
    if (index > 20000) force_N = 0.5f;
  };
  const JudgedCase judged = s.judge(s.run());
  EXPECT_TRUE(judged.safety_stop);
  EXPECT_TRUE(judged.safety_cause_decided);
  EXPECT_EQ(find(judged, "safety_stop")->verdict, Verdict::fail);
  EXPECT_EQ(find(judged, "safety_stop")->blame, Blame::firmware);
}

TEST(Runner, charges_a_build_whose_first_answer_is_no_number_with_the_stop_of_the_closed_loop) {
  for (const float force : {std::nanf(""), INFINITY, -INFINITY})
    for (const std::uint32_t from : {0u, 40u, 25000u}) {
      Bench s;
      s.close_loop();
      s.dut.spoil = [=](std::uint32_t index, float& force_N, std::uint8_t&) {
        if (index >= from) force_N = force;
      };
      const JudgedCase judged = s.judge(s.run());
      EXPECT_EQ(find(judged, "output_finite")->verdict, Verdict::fail) << from;
      EXPECT_EQ(find(judged, "output_finite")->blame, Blame::firmware) << from;
      for (const JudgedCheck& j : judged.checks) EXPECT_NE(j.check.verdict, Verdict::rig_error) << j.check.id << " " << from;
    }
}

TEST(Runner, does_not_charge_a_build_with_a_stop_after_which_it_agreed_with_the_reference) {
  Bench s;
  s.close_loop();
  s.job.safety.force_max_N = 2.5;
  const JudgedCase judged = s.judge(s.run());
  EXPECT_TRUE(judged.safety_stop);
  EXPECT_FALSE(judged.safety_cause_decided);
}

TEST(Runner, leaves_the_start_window_out_of_the_error_but_limits_it) {
  Bench s;
  s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t& flags) {
    if (index < 30000) {
      flags |= kDutLearning;
      force_N *= 0.5f;
    }
  };
  const JudgedCase judged = s.judge(s.run());
  EXPECT_LT(find(judged, "mre_maxima")->value, 0.05);
  EXPECT_NEAR(find(judged, "learning_window")->value, 30.0, 1e-6);
  EXPECT_EQ(find(judged, "learning_window")->verdict, Verdict::fail);
}

TEST(Runner, sees_a_static_hold_that_is_amplified) {
  for (const float factor : {1.0f, 1.3f}) {
    Bench s;
    s.job.planned.checks = kCheckHold;
    s.job.planned.stimulus = {};
    s.job.planned.stimulus.name = "jump";
    s.job.planned.stimulus.numbers = {{"A_N", 1.0}, {"m_N", 2.0}, {"ramp_s", 2.0}};
    s.job.planned.stimulus.lists = {{"f_Hz", {0.5, 0.0}}, {"stretch_s", {60.5, 60.0}}};
    s.dut.spoil = [factor](std::uint32_t index, float& force_N, std::uint8_t&) {
      if (index > 63000) force_N *= factor;
    };
    const CaseRecord r = s.run();
    EXPECT_NEAR(r.hold.seconds, 30.0, 0.2);
    const JudgedCase judged = s.judge(r);
    const Check* c = find(judged, "hold_amplification");
    ASSERT_NE(c, nullptr);
    EXPECT_EQ(c->verdict, factor > 1.0f ? Verdict::fail : Verdict::pass);
  }
}

TEST(Runner, rows_that_come_late_are_the_link_s_and_not_the_wheel_s) {
  Bench s;
  CaseRecord r = s.run();
  r.raw_lag_s = 0.067;
  r.observed.following_rad = 0.09;
  const JudgedCase late = s.judge(r);
  EXPECT_FALSE(find(late, "rig_following")->required);
  EXPECT_EQ(find(late, "rig_following")->blame, Blame::link);
  EXPECT_EQ(find(late, "rig_sensor_sync")->blame, Blame::link);
  r.raw_lag_s = 0.0;
  const JudgedCase wheel = s.judge(r);
  EXPECT_TRUE(find(wheel, "rig_following")->required);
  EXPECT_EQ(find(wheel, "rig_following")->blame, Blame::rig);
}

TEST(Runner, a_record_that_is_shorter_than_the_start_window_is_the_plan_s) {
  Bench s;
  s.job.planned.stimulus.numbers["duration_s"] = 10.0;
  s.dut.spoil = [](std::uint32_t, float&, std::uint8_t& flags) { flags |= kDutLearning; };
  const Check* c = nullptr;
  const JudgedCase judged = s.judge(s.run());
  c = find(judged, "mre_maxima");
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->verdict, Verdict::not_run);
  EXPECT_EQ(c->blame, Blame::user);
  EXPECT_EQ(c->evidence.find("nan"), std::string::npos) << c->evidence;
}

TEST(Runner, an_instrument_that_saw_the_firmware_fail_charges_it_and_names_itself_otherwise) {
  Bench s;
  CaseRecord r = s.run();
  r.failure = CaseFailure{CaseFailure::Stage::rig, {ErrorCode::firmware, "the firmware crashed", "board", {}}};
  const JudgedCase crashed = s.judge(r);
  EXPECT_EQ(find(crashed, "firmware_runs")->verdict, Verdict::fail);
  EXPECT_EQ(find(crashed, "firmware_runs")->blame, Blame::firmware);
  r.failure = CaseFailure{CaseFailure::Stage::rig, {ErrorCode::device, "the far end is gone", "reference: /dev/ttyS0", {}}};
  const JudgedCase pulled = s.judge(r);
  EXPECT_EQ(find(pulled, "rig_runs")->blame, Blame::reference);
  EXPECT_EQ(find(pulled, "rig_runs")->evidence, "reference: the far end is gone");
}

TEST(Blame, a_board_that_falls_silent_twice_at_one_sample_is_not_its_cable) {
  const auto silent = [](std::uint64_t sample, ErrorCode code = ErrorCode::timeout, const char* where = "board") {
    CaseRecord r;
    r.failure = CaseFailure{CaseFailure::Stage::rig, {code, "silent", where, {}}, Blame::none, sample};
    return r;
  };
  EXPECT_TRUE(silent_at_the_same_sample(silent(40000), silent(40000)));
  EXPECT_FALSE(silent_at_the_same_sample(silent(40000), silent(40010)));
  EXPECT_FALSE(silent_at_the_same_sample(silent(0), silent(0))) << "a stream that never began";
  EXPECT_FALSE(silent_at_the_same_sample(silent(40000, ErrorCode::device), silent(40000, ErrorCode::device))) << "its firmware runs";
  EXPECT_FALSE(silent_at_the_same_sample(silent(40000, ErrorCode::timeout, "reference"), silent(40000, ErrorCode::timeout, "reference")));
  EXPECT_FALSE(silent_at_the_same_sample({}, silent(40000)));
}

TEST(Runner, survives_the_trip_through_the_pipe) {
  Bench s;
  s.dut.spoil = [](std::uint32_t index, float& force_N, std::uint8_t&) {
    if (index == 7) force_N = std::nanf("");
  };
  const CaseRecord r = s.run();
  const auto back = record_from_json(to_json(r));
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(to_json(*back), to_json(r));
  const auto job = job_from_json(to_json(s.job));
  ASSERT_TRUE(job);
  EXPECT_EQ(to_json(*job), to_json(s.job));
  EXPECT_FALSE(record_from_json("{\"id\": 3"));
  EXPECT_FALSE(record_from_json("{}"));
}

TEST(Calibration, static_sweeps_find_gain_and_offset) {
  Bench s;
  s.rig.gain_N_per_V = 0.53;
  s.rig.offset_N = 0.07;
  s.job.kind = CaseJob::Kind::calibration;
  s.job.specimen = "fake";
  s.job.calibrate.level = CalibrationLevel::statical;
  const CaseRecord r = run_calibration(s.job, s.rig);
  ASSERT_FALSE(r.failure) << r.failure->error.to_text();
  EXPECT_NEAR(r.calibration.gain_N_per_V, 0.53, 1e-4);
  EXPECT_NEAR(r.calibration.offset_N, 0.07, 1e-3);
  EXPECT_EQ(r.calibration.level, CalibrationLevel::statical);
}

TEST(Calibration, fails_on_a_sensor_that_does_not_answer) {
  Bench s;
  s.rig.gain_N_per_V = 1e9;
  s.job.kind = CaseJob::Kind::calibration;
  s.job.calibrate.level = CalibrationLevel::statical;
  const CaseRecord r = run_calibration(s.job, s.rig);
  ASSERT_TRUE(r.failure);
  EXPECT_EQ(r.failure->stage, CaseFailure::Stage::rig);
}

}  // namespace
}  // namespace forcegate
