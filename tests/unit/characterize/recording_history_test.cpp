// A recording that holds more than one movement, or more than the converter reads.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/characterize/recording.h"
#include "tests/support/value_or_abort.h"
#include "tests/unit/characterize/recorded_rig.h"

namespace forcegate::test {
namespace {

using namespace characterize;

constexpr double kFirst_s = 300.0, kB = 0.0064, kQ = 0.397;

// Cycles of 0.5 Hz from 0.5 N on, of amplitude `first_N` and then 1.05 N; by the law the signal decays from the beginning.
RecordedRig cycled_before(double first_N) {
  RecordedRig rig;
  for (int i = 0; i < 150000; ++i) {
    const double t = 0.01 * i, A = t < kFirst_s ? first_N : 1.05, above = A * (1.0 - std::cos(3.14159265358979 * t));
    rig.force_N.push_back(static_cast<float>(0.5 + above));
    rig.sensor_V.push_back(static_cast<float>(1.2 + 2.0 * above * (std::exp(-kB * t) + kQ) / (1.0 + kQ)));
  }
  return rig;
}

SessionSheet sheet_of(RecordedRig rig) {
  BenchProgress progress;
  return value_or_abort(characterize_recording(rig, "r", progress));
}

bool has_note(const SessionSheet& sheet, std::string_view what) {
  return std::ranges::any_of(sheet.notes, [&](const std::string& n) { return n.find(what) != std::string::npos; });
}

TEST(RecordingHistory, cycles_before_the_steady_stretch_leave_b_alone_to_be_told) {
  for (const double first_N : {0.7, 0.2}) {  // turns of 0.2 N are too small for those that are fitted
    const SessionSheet sheet = sheet_of(cycled_before(first_N));
    EXPECT_NEAR(sheet.value("recording.b"), kB, 0.0003) << first_N;
    EXPECT_FALSE(std::isnan(sheet.value("identified.b"))) << first_N;
    for (const char* key : {"recording.a", "recording.c", "identified.q"}) EXPECT_TRUE(std::isnan(sheet.value(key))) << first_N << " " << key;
    EXPECT_EQ(sheet.calibration.q_scale, 1.0) << first_N;
    ASSERT_EQ(sheet.decays.size(), 1u);
    EXPECT_TRUE(std::isnan(sheet.decays.front().fit.c_V)) << first_N;
    EXPECT_TRUE(has_note(sheet, "the force was cycled for ")) << first_N;
    EXPECT_FALSE(has_note(sheet, "the time of eq. (3) counts from there")) << first_N;
  }
}

TEST(RecordingHistory, cycles_from_rest_tell_c_over_a) {
  const SessionSheet sheet = sheet_of(cycled_before(1.05));
  EXPECT_NEAR(sheet.value("recording.c") / sheet.value("recording.a"), kQ, 0.01);
  EXPECT_TRUE(sheet.notes.empty()) << sheet.notes.front();
}

TEST(RecordingHistory, samples_beyond_the_converter_are_not_in_the_static_law) {
  RecordedRig rig;
  for (int i = 0; i < 12000; ++i) {
    const double force = 3.9 * (1.0 - std::abs(std::fmod(0.01 * i, 60.0) / 30.0 - 1.0));
    rig.force_N.push_back(static_cast<float>(force));
    rig.sensor_V.push_back(static_cast<float>((force - 0.2) / 0.3));  // 0 .. 12 V: 10 V are 3.2 N
  }
  rig.notes = "U reaches 12.3 V, the converter's range is 10 V: 2154 rows were cut off there";
  const SessionSheet sheet = sheet_of(rig);
  EXPECT_NEAR(sheet.value("static.gain"), 0.3, 0.0001);
  EXPECT_NEAR(sheet.value("static.offset"), 0.2, 0.001);
  EXPECT_TRUE(has_note(sheet, "the static law is told without them"));
  EXPECT_TRUE(has_note(sheet, rig.notes));
}

TEST(RecordingHistory, of_cycles_that_are_cut_off_says_so) {
  RecordedRig rig = cycled_before(1.05);
  for (float& U_V : rig.sensor_V) U_V *= 2.0F;
  EXPECT_TRUE(has_note(sheet_of(rig), "turns there are cut off"));
}

}  // namespace
}  // namespace forcegate::test
