// What is wrong with a recording is nobody's firmware.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "tests/unit/gate/runner_bench.h"

namespace forcegate {
namespace {

using testing::Bench;

// A recording: no wheel, ATI and code as they were written. U = (F - F0) / G of the bench's fake sensor.
struct Recording : Bench {
  std::function<void(double t_s, double& ati_N, double& volts)> written;
  Recording() {
    RigInfo& info = rig.change_info();
    info.can_move = info.emulated = false;
    info.geometry = {};
    job.calibration_given = true;
    job.calibration.level = CalibrationLevel::statical;
    rig.spoil = [this](std::size_t row, double t_s, RigBlock& b) {
      const double force_N = 2.0 + std::sin(3.141592653589793 * t_s);
      double ati_N = force_N, volts = (force_N - rig.offset_N) / rig.gain_N_per_V;
      if (written) written(t_s, ati_N, volts);
      b.force_ref_N[row] = static_cast<float>(ati_N);
      b.adc[row] = static_cast<std::uint16_t>(std::lround(std::fmin(std::fmax(volts / 10.0, 0.0), 1.0) * 65535.0));
      b.theta_rad[row] = std::nanf("");
      b.setpoint_N[row] = std::nanf("");
      b.status[row] = 0;
    };
  }
  // The first check that takes the record out of the judgement; nothing may be charged to the firmware.
  Check spoiled_by() {
    const JudgedCase judged = judge(run());
    Check first;
    for (const JudgedCheck& j : judged.checks) {
      if (first.id.empty() && (j.check.verdict == Verdict::rig_error || j.check.verdict == Verdict::inconclusive)) first = j.check;
      EXPECT_NE(j.check.verdict, Verdict::fail) << j.check.id << " " << j.check.evidence;
    }
    return first;
  }
};

TEST(Recording, of_a_sound_sensor_passes) {
  Recording s;
  EXPECT_EQ(s.spoiled_by().id, "");
}

TEST(Recording, a_calibration_of_another_specimen_is_the_calibration_s) {
  for (const CalibrationLevel level : {CalibrationLevel::statical, CalibrationLevel::nominal}) {
    Recording s;
    s.job.calibration.gain_N_per_V *= 2.0;
    s.job.calibration.level = level;
    const Check c = s.spoiled_by();
    EXPECT_EQ(c.id, "rig_calibration_fits");
    EXPECT_EQ(c.verdict, Verdict::inconclusive) << "no retry mends a file";
    EXPECT_EQ(c.blame, Blame::calibration);
    EXPECT_EQ(c.evidence.find("--cal FILE") != std::string::npos, level == CalibrationLevel::nominal) << c.evidence;
  }
}

TEST(Recording, columns_that_are_exchanged_are_named) {
  Recording s;
  s.written = [](double, double& ati_N, double& volts) { std::swap(ati_N, volts); };
  const Check c = s.spoiled_by();
  EXPECT_EQ(c.blame, Blame::calibration);
  EXPECT_NE(c.evidence.find("exchanged"), std::string::npos) << c.evidence;
}

TEST(Recording, a_divider_that_nobody_told_of_is_a_factor) {
  for (const double share : {0.5, 0.6}) {
    Recording s;
    s.job.calibration.level = CalibrationLevel::statical;
    s.written = [share](double, double&, double& volts) { volts *= share; };
    const Check c = s.spoiled_by();
    EXPECT_EQ(c.id, "rig_calibration_fits");
    EXPECT_NE(c.evidence.find(share == 0.5 ? "the sensor's volts times 2 would fit" : "the sensor's volts times 1.7 would fit"), std::string::npos) << c.evidence;
  }
}

TEST(Recording, an_amplifier_that_cuts_off_is_the_sensor_channel_s) {
  Recording s;
  s.written = [](double, double&, double& volts) { volts = std::fmin(volts, 5.0); };
  const Check c = s.spoiled_by();
  EXPECT_EQ(c.id, "rig_sensor");
  EXPECT_EQ(c.blame, Blame::sensor);
  EXPECT_NE(c.evidence.find("cut off"), std::string::npos) << c.evidence;
}

TEST(Recording, a_reference_that_stands_still_or_is_late_is_the_reference_s) {
  Recording frozen;
  frozen.written = [](double t_s, double& ati_N, double&) {
    if (t_s > 30.0 && t_s < 35.0) ati_N = 2.0;
  };
  EXPECT_EQ(frozen.spoiled_by().id, "rig_reference_alive");
  EXPECT_EQ(frozen.spoiled_by().blame, Blame::reference);
  Recording late;
  late.written = [](double t_s, double& ati_N, double&) { ati_N = 2.0 + std::sin(3.141592653589793 * (t_s - 0.04)); };
  EXPECT_EQ(late.spoiled_by().id, "rig_sensor_sync");
  EXPECT_EQ(late.spoiled_by().blame, Blame::reference);
  EXPECT_NE(late.spoiled_by().evidence.find("the ATI is 40."), std::string::npos) << late.spoiled_by().evidence;
}

TEST(Recording, a_reference_that_is_slower_than_the_file_is_not_taken_for_a_frozen_one) {
  Recording s;
  s.written = [](double t_s, double& ati_N, double&) { ati_N = 2.0 + std::sin(3.141592653589793 * std::floor(25.0 * t_s + 0.5) / 25.0); };
  EXPECT_EQ(s.spoiled_by().id, "");
}

TEST(Recording, a_film_that_creeps_under_a_reference_of_coarse_steps_is_no_frozen_reference) {
  Recording s;
  s.written = [](double t_s, double& ati_N, double& volts) {
    if (t_s > 20.0) ati_N = 2.0, volts = 3.8 + 0.01 * (t_s - 20.0);
  };
  EXPECT_EQ(s.spoiled_by().id, "");
}

}  // namespace
}  // namespace forcegate
