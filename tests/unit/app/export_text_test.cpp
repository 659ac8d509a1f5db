// What the check of an exported header says to people.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hil/app/export/export.h"
#include "hil/app/model/never_fitted.h"
#include "hil/model/model_toml.h"

namespace forcegate {
namespace {

using testing::HasSubstr;

TEST(ExportText, SaysWhatEveryNumberOfAReplayedRecordIs) {
  for (const bool bare : {true, false}) {
    ExportResult r;
    if (!bare) r.compensator.effects = {"creep"};
    r.check.emplace();
    r.check->lsb_N = 0.01;
    ReplayedRecord record;
    record.record = "r05", record.seconds = 200.0, record.largest_N = 0.02, record.plain_rms_N = record.compensated_rms_N = 0.18;
    r.check->records = {record};
    const std::string text = export_text(r);
    EXPECT_THAT(text, HasSubstr("against recorded force and the largest difference from the model's own inverse, RMS in mN (the law alone"));
    EXPECT_THAT(text, HasSubstr(bare ? " s    180.0, difference 2 LSB" : " s    180.0 -> 180.0, difference 2 LSB"));
  }
}

TEST(ExportText, WarnsWhereTheHeaderGainsNothingAndNotOfTheLawAlone) {
  for (const bool bare : {true, false}) {
    ExportResult r;
    if (!bare) r.compensator.effects = {"creep"};
    r.check.emplace();
    r.check->plain_rms_N = 0.05, r.check->compensated_rms_N = bare ? 0.05 : 0.0505;
    const std::string text = export_text(r);
    EXPECT_EQ(text.find("warning: the error on these records is not smaller") == std::string::npos, bare) << text;
    EXPECT_EQ(nlohmann::json::parse(export_json(r))["check"]["gains_nothing"] == "", bare);
  }
}

TEST(ExportJson, SaysWhatTheTextNotes) {
  ExportResult r;
  r.compensator.effects = {"creep"};
  r.self.why_not = "there is no C compiler";
  r.fit.emplace();
  r.fit->records = {{"a", 0.01, 0.02}, {"b", 0.02, 0.01}};
  r.fit->notes = {"of the fit"};
  r.notes = {"of the header"};
  r.check.emplace();
  r.check->assumed = "an LSB is here that of 16 bits over 10 V";
  const std::string text = export_text(r);
  const auto json = nlohmann::json::parse(export_json(r));
  std::vector<std::string> told = json["notes"];
  for (const std::string note : json["fit"]["notes"]) told.push_back(note);
  told.push_back(json["check"]["assumed"]);
  EXPECT_THAT(told, testing::UnorderedElementsAre("1 of 2 records is worse with the effects than with the law alone", "of the fit", "of the header",
                                                  "not held against the model's own inverse: there is no C compiler", "an LSB is here that of 16 bits over 10 V"));
  for (const std::string& note : told) EXPECT_THAT(text, HasSubstr("note: " + note + "\n"));
  EXPECT_THAT(export_text(r, false), testing::Not(HasSubstr("note: "))) << "as --quiet asks";
  ASSERT_EQ(json["fit"]["records"].size(), 2u);
  EXPECT_EQ(json["fit"]["records"][0]["record"], "a");
  EXPECT_EQ(json["fit"]["records"][0]["model_V"], 0.02);
}

TEST(ExportText, OfAnEffectWithoutAStrengthSaysThatNothingIsDone) {
  const auto notes = [](const std::string& strength) {
    const auto model = parse_model("[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = 0.1\n[[effect]]\nname = \"lag\"\nshape.tau_s = 0.005\n" + strength, "m.toml");
    EXPECT_TRUE(model) << model.error().to_text();
    return undone_as_written_notes(model.value_or(Model{}));
  };
  EXPECT_THAT(notes(""), testing::ElementsAre(HasSubstr("lag has no strength in the model file, or one of 0: the header does nothing about it")));
  EXPECT_THAT(notes("strength.c = 1.0\n"), testing::ElementsAre(HasSubstr("the header undoes it with the numbers that are written")));
}

}  // namespace
}  // namespace forcegate
