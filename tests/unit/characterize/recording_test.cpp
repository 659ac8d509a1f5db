// A recording in the place of a rig.

#include "hil/characterize/recording.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/value_or_abort.h"
#include "tests/unit/characterize/recorded_rig.h"

namespace forcegate::test {
namespace {

using namespace characterize;

// Twenty minutes of cycles at 0.5 Hz with a = 4 V, b = 0.006 1/s and c = 1 V, behind a rest.
RecordedRig decaying_cycles(double rest_s = 0.0) {
  RecordedRig rig;
  for (int i = 0; i < static_cast<int>(100.0 * (rest_s + 1200.0)); ++i) {
    const double t = 0.01 * i - rest_s, s = t < 0.0 ? 0.0 : 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979 * 0.5 * t);
    rig.force_N.push_back(static_cast<float>(1.0 + 3.0 * s));
    rig.sensor_V.push_back(static_cast<float>(2.0 + s * (4.0 * std::exp(-0.006 * t) + 1.0)));
  }
  return rig;
}

TEST(Recording, of_cycles_gives_the_decay_that_is_in_it) {
  RecordedRig rig = decaying_cycles();
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_NEAR(sheet.value("recording.frequency"), 0.5, 0.001);
  EXPECT_NEAR(sheet.value("recording.amplitude"), 1.5, 0.01);
  EXPECT_NEAR(sheet.value("recording.a"), 4.0, 0.03);
  EXPECT_NEAR(sheet.value("recording.b"), 0.006, 0.0001);
  EXPECT_NEAR(sheet.value("recording.c"), 1.0, 0.02);
  EXPECT_NEAR(sheet.value("identified.b"), 0.006 / 0.00655, 0.02);
  EXPECT_TRUE(std::isnan(sheet.value("static.gain")));
}

TEST(Recording, counts_the_time_of_the_decay_from_the_first_cycle) {
  RecordedRig rig = decaying_cycles(200.0);
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_NEAR(sheet.value("recording.a"), 4.0, 0.03);
  EXPECT_NEAR(sheet.value("recording.c"), 1.0, 0.02);
  ASSERT_EQ(sheet.decays.size(), 1u);
  EXPECT_NEAR(sheet.decays.front().duration_s, 1200.0, 1.0);
  ASSERT_FALSE(sheet.notes.empty());
  EXPECT_NE(sheet.notes.front().find("the cycles begin 200 s behind"), std::string::npos) << sheet.notes.front();
}

TEST(Recording, tells_the_same_however_many_samples_a_cycle_has) {
  for (const double rate_Hz : {1000.0, 100.0, 50.0, 20.0}) {  // of cycles of 0.5 s
    RecordedRig rig;
    rig.rate_Hz = rate_Hz;
    for (int i = 0; i < static_cast<int>(200.0 * rate_Hz); ++i) {
      const double t = i / rate_Hz + 0.003, F = 2.0 + std::sin(2.0 * 3.14159265358979 * 2.0 * t), D = (std::exp(-0.02 * t) + 0.5) / 1.5;
      rig.force_N.push_back(static_cast<float>(F));
      rig.sensor_V.push_back(static_cast<float>(2.0 * (1.0 + D * (F - 1.0))));
    }
    BenchProgress progress;
    const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
    EXPECT_NEAR(sheet.value("recording.amplitude"), 1.0, 0.01) << rate_Hz;
    EXPECT_NEAR(sheet.value("recording.c") / sheet.value("recording.a"), 0.5, 0.02) << rate_Hz;
    EXPECT_NEAR(sheet.value("recording.minima_drift"), 0.0, 0.15) << rate_Hz;
    EXPECT_TRUE(sheet.notes.empty()) << sheet.notes.front();
  }
}

TEST(Recording, in_counts_of_an_unknown_converter_is_refused) {
  RecordedRig rig = decaying_cycles();
  rig.assumed = "adc_bits = 16, v_range_V = 10";
  BenchProgress progress;
  EXPECT_TRUE(characterize_recording(rig, "r", progress)) << "of volts the gain is known";
  rig = decaying_cycles();
  rig.assumed = "adc_bits = 16, v_range_V = 10";
  rig.in_counts = true;
  const auto none = characterize_recording(rig, "r", progress);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().to_text().find("nothing says what a count is"), std::string::npos) << none.error().to_text();
  EXPECT_NE(none.error().to_text().find("--rig-option adc_bits="), std::string::npos);
}

TEST(Recording, cut_at_another_movement_takes_nothing_of_it) {
  RecordedRig rig;
  const auto triangle = [](double t, double period_s, double low, double high) {
    const double x = std::fmod(t / period_s, 1.0);
    return low + (high - low) * (1.0 - std::abs(2.0 * x - 1.0));
  };
  for (int i = 0; i < 20000; ++i) {
    const double t = 0.01 * i, F = t < 70.0 ? triangle(t, 35.0, 0.3, 4.0) : t < 130.0 ? triangle(t - 70.0, 5.0, 0.3, 4.0) : triangle(t - 130.0, 20.0, 1.0, 2.5);
    rig.force_N.push_back(static_cast<float>(F));
    rig.sensor_V.push_back(static_cast<float>(2.0 * F));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  ASSERT_FALSE(sheet.notes.empty());
  EXPECT_NE(sheet.notes.front().find("cut to "), std::string::npos) << sheet.notes.front();
  EXPECT_NEAR(sheet.value("recording.minima_drift"), 0.0, 0.1);
}

TEST(Recording, of_a_slow_sweep_gives_the_static_law) {
  RecordedRig rig;
  for (int i = 0; i < 12000; ++i) {
    const double phase = std::abs(std::fmod(0.01 * i, 60.0) / 30.0 - 1.0), force = 0.3 + 3.7 * (1.0 - phase);
    rig.force_N.push_back(static_cast<float>(force));
    rig.sensor_V.push_back(static_cast<float>((force - 0.2) / 0.48));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_NEAR(sheet.value("static.gain"), 0.48, 0.001);
  EXPECT_NEAR(sheet.value("static.offset"), 0.2, 0.002);
}

double sine(double t_s, double f_Hz) { return 0.5 - 0.5 * std::cos(2.0 * 3.14159265358979 * f_Hz * t_s); }

TEST(Recording, whose_force_swings_less_later_does_not_blame_the_sensor) {
  RecordedRig rig;  // a ramp to 6 N, a hold, then 250 cycles of 3 N: the output is in proportion throughout
  for (int i = 0; i < 80000; ++i) {
    const double t = 0.01 * i,
                 force =
                     t < 60.0 ? 0.1 * t : (t < 300.0 ? 6.0 * (t < 200.0) : 0.5 + 3.0 * sine(t - 300.0, 0.5));
    rig.force_N.push_back(static_cast<float>(force));
    rig.sensor_V.push_back(static_cast<float>(0.2 + 0.4 * force));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_NEAR(sheet.value("recording.loss"), 0.0, 0.1);
  EXPECT_NEAR(sheet.value("recording.frequency"), 0.5, 0.001);
  EXPECT_TRUE(std::isnan(sheet.value("recording.a")));
  EXPECT_TRUE(std::isnan(sheet.value("identified.b")));
  ASSERT_EQ(sheet.notes.size(), 2u);
  EXPECT_NE(sheet.notes[0].find("cut to 301 .. 799 s"), std::string::npos) << sheet.notes[0];
  EXPECT_NE(sheet.notes[1].find("no decay"), std::string::npos) << sheet.notes[1];
}

TEST(Recording, whose_cycles_all_differ_gives_the_static_law_over_its_own_largest_force) {
  RecordedRig rig;  // presses of 4 to 20 N, never two alike in a row
  for (int i = 0; i < 30000; ++i) {
    const double t = 0.01 * i, force = (4.0 + 4.0 * (static_cast<int>(t / 4.0) * 3 % 5)) * sine(t, 0.25);
    rig.force_N.push_back(static_cast<float>(force));
    rig.sensor_V.push_back(static_cast<float>(0.1 + 0.2 * force + (i % 2 == 0 ? 0.02 : -0.02)));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_NEAR(sheet.value("static.gain"), 5.0, 0.01);
  EXPECT_NEAR(sheet.value("static.residual_share"), 0.5, 0.01);
  EXPECT_TRUE(std::isnan(sheet.value("recording.loss")));
  ASSERT_EQ(sheet.notes.size(), 1u);
  EXPECT_NE(sheet.notes[0].find("changes from cycle to cycle"), std::string::npos);
}

TEST(Recording, of_cycles_that_keep_their_height_has_no_decay) {
  RecordedRig rig;
  for (int i = 0; i < 60000; ++i) {
    const double s = sine(0.01 * i, 0.2);
    rig.force_N.push_back(static_cast<float>(0.5 + 4.0 * s));
    rig.sensor_V.push_back(static_cast<float>(0.2 + 1.2 * s + 0.0015 * std::sin(0.37 * (i / 500))));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_TRUE(std::isnan(sheet.value("recording.c")));
  ASSERT_EQ(sheet.notes.size(), 1u);
  EXPECT_NE(sheet.notes[0].find("no decay of the maxima is seen over 600 s"), std::string::npos);
}

TEST(Recording, whose_maxima_fall_in_a_straight_line_is_not_said_to_keep_them) {
  RecordedRig rig;
  for (int i = 0; i < 60000; ++i) {
    const double s = sine(0.01 * i, 0.2);
    rig.force_N.push_back(static_cast<float>(0.5 + 4.0 * s));
    rig.sensor_V.push_back(static_cast<float>(0.2 + 1.2 * s * (1.0 - 0.1 * i / 60000.0)));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  EXPECT_TRUE(std::isnan(sheet.value("identified.b")));
  ASSERT_EQ(sheet.notes.size(), 1u);
  EXPECT_NE(sheet.notes[0].find("the maxima fall by 9"), std::string::npos) << sheet.notes[0];
}

TEST(Recording, without_motion_or_without_an_answer_is_refused) {
  RecordedRig still, deaf;
  for (int i = 0; i < 5000; ++i) {
    still.force_N.push_back(1.0F), still.sensor_V.push_back(2.0F);
    deaf.force_N.push_back(static_cast<float>(0.001 * i)), deaf.sensor_V.push_back(2.0F);
  }
  BenchProgress progress;
  EXPECT_FALSE(characterize_recording(still, "r", progress).has_value());
  const auto answer = characterize_recording(deaf, "r", progress);
  ASSERT_FALSE(answer.has_value());
  EXPECT_NE(answer.error().text.find("did not answer"), std::string::npos);
}

TEST(Recording, whose_output_falls_with_the_force_is_told_so) {
  RecordedRig rig;
  for (int i = 0; i < 6000; ++i) {
    rig.force_N.push_back(static_cast<float>(0.0005 * i));
    rig.sensor_V.push_back(static_cast<float>(8.0 - 0.001 * i));
  }
  BenchProgress progress;
  const auto refused = characterize_recording(rig, "r", progress);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text, "the output falls while the force rises");
  EXPECT_NE(refused.error().hint.find("wrong sign"), std::string::npos);
}

TEST(Recording, whose_converter_nobody_stated_says_so_in_notes_and_calibration) {
  RecordedRig rig;
  rig.assumed = "adc_bits = 16, v_range_V = 10";
  for (int i = 0; i < 6000; ++i) {
    rig.force_N.push_back(static_cast<float>(0.0005 * i));
    rig.sensor_V.push_back(static_cast<float>(1.0 + 0.001 * i));
  }
  BenchProgress progress;
  const SessionSheet sheet = value_or_abort(characterize_recording(rig, "r", progress));
  ASSERT_EQ(sheet.notes.size(), 1u);
  EXPECT_NE(sheet.notes[0].find("adc_bits = 16, v_range_V = 10 in the calibration file are assumed"), std::string::npos) << sheet.notes[0];
  EXPECT_EQ(sheet.assumed_converter, "adc_bits = 16, v_range_V = 10");
}

}  // namespace
}  // namespace forcegate::test
