// Recordings in a study: what they are called, and what of them goes into files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/app/characterize/recordings.h"
#include "hil/report/characterization/data_sheet.h"
#include "tests/support/value_or_abort.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using characterize::SensorStudy;
using characterize::SessionSheet;

SessionSheet slow(const std::string& name, double gain_N_per_V) {
  SessionSheet sheet;
  sheet.specimen = name;
  sheet.values = {{"static.gain", "Gain G, eq. (1)", "N/V", gain_N_per_V}, {"static.offset", "Offset F0, eq. (1)", "N", -0.1}};
  sheet.calibration.gain_N_per_V = gain_N_per_V;
  sheet.calibration.offset_N = -0.1;
  sheet.calibration.level = CalibrationLevel::statical;
  return sheet;
}

SessionSheet cyclic(const std::string& name) {
  SessionSheet sheet;
  sheet.specimen = name;
  sheet.values = {{"identified.b", "Decay rate", "1", 1.2}, {"identified.q", "Ratio", "1", 0.7}};
  sheet.calibration.b_scale = 1.2;
  sheet.calibration.q_scale = 0.7;
  return sheet;
}

SensorStudy study_of(std::vector<SessionSheet> sheets) {
  SensorStudy study;
  study.sensor = "recording";
  study.of_recordings = true;
  study.sheets = std::move(sheets);
  characterize::summarise(study, {});
  return study;
}

TEST(CharacterizedRecordings, AreNamedByAsManyFoldersAsTellThemApart) {
  const std::vector<std::filesystem::path> all{"/x/A/ramp.csv", "/y/A/ramp.csv", "/y/B/ramp.csv", "/y/hold.csv", "/y/./hold.csv"};
  EXPECT_EQ(name_of_recording(all[0], all), "x/A/ramp.csv");
  EXPECT_EQ(name_of_recording(all[1], all), "y/A/ramp.csv");
  EXPECT_EQ(name_of_recording(all[2], all), "B/ramp.csv");
  EXPECT_EQ(name_of_recording(all[3], all), "hold.csv");
  EXPECT_EQ(name_of_recording("/ramp.csv", {"/ramp.csv", "/A/ramp.csv"}), "/ramp.csv");
  EXPECT_EQ(name_of_recording("/A/ramp.csv", {"/ramp.csv", "/A/ramp.csv"}), "A/ramp.csv");
}

TEST(CharacterizedRecordings, OneSlowAndOneCyclicMakeOneCalibration) {
  const auto both = sheet_of_both(study_of({cyclic("sine.csv"), slow("ramp.csv", 0.5)}));
  ASSERT_TRUE(both);
  EXPECT_THAT(calibration_text(*both), HasSubstr("# ramp.csv and sine.csv, "));
  EXPECT_THAT(calibration_text(*both), HasSubstr("gain_N_per_V = 0.5\noffset_N = -0.1\nb_scale = 1.2\nq_scale = 0.7\n"));
  EXPECT_THAT(calibration_text(*both), HasSubstr("level = \"identified\""));
}

TEST(CharacterizedRecordings, OfWhichNothingSaysThatTheyAreOfOneSensorMakeNone) {
  EXPECT_FALSE(sheet_of_both(study_of({slow("ramp.csv", 0.5), slow("other.csv", 0.6), cyclic("sine.csv")})));
  EXPECT_FALSE(sheet_of_both(study_of({slow("ramp.csv", 0.5), slow("other.csv", 0.6)})));
  EXPECT_FALSE(sheet_of_both(study_of({cyclic("sine.csv")})));
  SessionSheet rate_alone = cyclic("sine.csv");
  rate_alone.values.pop_back();
  EXPECT_FALSE(sheet_of_both(study_of({slow("ramp.csv", 0.5), rate_alone})));
  SensorStudy specimens = study_of({cyclic("q25"), slow("q75", 0.5)});
  specimens.of_recordings = false;
  EXPECT_FALSE(sheet_of_both(specimens));
}

TEST(CharacterizedRecordings, AreNoSpecimensInSheetAndModel) {
  const SensorStudy two = study_of({slow("ramp.csv", 0.5), slow("other.csv", 0.9)});
  const std::string sheet = data_sheet_html(two, {}, "forcegate characterize");
  EXPECT_THAT(sheet, HasSubstr("2 recordings, 0.0 min"));
  EXPECT_THAT(sheet, HasSubstr("sd of recordings"));
  EXPECT_THAT(sheet, Not(HasSubstr("specimen")));
  EXPECT_THAT(data_sheet_html(study_of({slow("ramp.csv", 0.5)}), {}, ""), HasSubstr("1 recording, "));
  const std::string model = value_or_abort(model_of_study(two)), of_one = value_or_abort(model_of_study(study_of({slow("ramp.csv", 0.7)})));
  EXPECT_THAT(model, HasSubstr("forcegate characterize, 2 recordings\""));
  EXPECT_THAT(of_one, HasSubstr("forcegate characterize, 1 recording\""));
  const auto se_of_gain = [](const std::string& text) { return text.substr(text.find("se = ", text.find("gain_N_per_V")), 12); };
  EXPECT_EQ(se_of_gain(model), se_of_gain(of_one)) << "how far two recordings differ is no standard error of the sensor's gain";
  SensorStudy one = study_of({slow("q50", 0.5)});
  one.of_recordings = false;
  EXPECT_THAT(value_or_abort(model_of_study(one)), HasSubstr("1 specimen, 1 session\""));
}

TEST(CharacterizedRecordings, OfOneValueThereAreNoQuantiles) {
  const auto unmeasured = [](const SensorStudy& study) {
    const std::string html = data_sheet_html(study, {}, "");
    std::size_t n = 0;
    for (std::size_t at = 0; (at = html.find(">not measured<", at)) != std::string::npos; ++at) ++n;
    return n;
  };
  EXPECT_EQ(unmeasured(study_of({slow("ramp.csv", 0.5)})), 2u * 4u) << "sd, 5 %, median and 95 % of gain and offset";
  EXPECT_EQ(unmeasured(study_of({slow("ramp.csv", 0.5), slow("other.csv", 0.9)})), 0u);
}

TEST(CharacterizedRecordings, TakeNeitherNameNorStandardErrorsNorADecayFromTheShippedSensor) {
  const std::string no_decay = value_or_abort(model_of_study(study_of({slow("ramp.csv", 2.8)})));
  EXPECT_THAT(no_decay, HasSubstr("sensor = \"\""));
  EXPECT_THAT(no_decay, HasSubstr("kind = \"static\""));
  EXPECT_THAT(no_decay, HasSubstr("se = 0.0, unit = \"N/V\""));
  EXPECT_THAT(no_decay, HasSubstr("se = 0.0, unit = \"N\""));
  const std::string decaying = value_or_abort(model_of_study(study_of({slow("ramp.csv", 2.8), cyclic("sine.csv")})));
  EXPECT_THAT(decaying, HasSubstr("kind = \"decaying\""));
  EXPECT_THAT(decaying, HasSubstr("b_scale = { value = 1.2, se = 0.0"));
  SensorStudy named = study_of({slow("ramp.csv", 0.5)});
  named.sensor = "flexiforce";
  EXPECT_THAT(value_or_abort(model_of_study(named)), HasSubstr("kind = \"decaying\""));
  EXPECT_THAT(value_or_abort(model_of_study(named)), HasSubstr("sensor = \"Tekscan FlexiForce A201\""));
  SessionSheet level = slow("sine.csv", 0.5);
  level.values.push_back({"recording.frequency", "Mean frequency of the cycles", "Hz", 0.5});
  named.sheets.push_back(level);
  characterize::summarise(named, {});
  EXPECT_THAT(value_or_abort(model_of_study(named)), HasSubstr("kind = \"static\"")) << "its cycles do not decay";
}

}  // namespace
}  // namespace forcegate::test
