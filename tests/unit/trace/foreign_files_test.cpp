// Files as strangers bring them: each works with a notice, or fails with its place and the way to mend it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hil/trace/csv_hints.h"
#include "hil/trace/campaign.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"
#include "hil/trace/csv.h"
#include "hil/trace/date_time.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

TEST(DateTime, ReadsStampsOfLoggersAndTimesOfDay) {
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("1970-01-02T00:00:01"), 86401.0);
  EXPECT_NEAR(*seconds_of_stamp("2026-11-21 10:00:00.250"), 1795255200.25, 1e-6);
  EXPECT_NEAR(*seconds_of_stamp("2026-11-21T11:00:00+01:00"), 1795255200.0, 1e-6);
  EXPECT_NEAR(*seconds_of_stamp("2026-11-21T10:00:00Z"), 1795255200.0, 1e-6);
  EXPECT_NEAR(*seconds_of_stamp("2026-11-21 12:00:00.000000 +0200"), 1795255200.0, 1e-6);
  EXPECT_NEAR(*seconds_of_stamp("2026-11-21 05:00:00 -05:00"), 1795255200.0, 1e-6);
  EXPECT_FALSE(seconds_of_stamp("2026-11-21 10:00:00 "));
  EXPECT_NEAR(*seconds_of_stamp("21.11.2026 10:00:00,5"), 1795255200.5, 1e-6);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("00:01:02.5"), 62.5);
  EXPECT_NEAR(*seconds_of_stamp("2024-03-01 00:00:00") - *seconds_of_stamp("2024-02-28 00:00:00"),
              2 * 86400.0, 1e-9);
}

TEST(DateTime, LeavesEverythingElseAlone) {
  for (const char* text : {"", "oops", "12", "2026-11-21", "11/21/2026 10:00:00", "2026-13-01 10:00:00",
                           "25:00:00", "10:00:00 and more", "2026-11-21T10:00:00X"})
    EXPECT_FALSE(seconds_of_stamp(text)) << text;
}

TEST(ForeignFiles, APageOrAnAnswerInJsonIsNoRecording) {
  for (const auto& [text, what] : {std::pair{"<!DOCTYPE html>\n<html><body>\n<table>\n", "a page in HTML or XML"}, {"\xEF\xBB\xBF\n<HTML>\n1,2\n", "a page in HTML or XML"},
                                   {"<?xml version=\"1.0\"?>\n<a/>\n", "a page in HTML or XML"}, {"{\n  \"format\": 1,\n  \"a\": [1, 2]\n}\n", "JSON"},
                                   {"[{\"t_s\": 0}]\n", "JSON"}, {"[[0, 1], [1, 2]]\n", "JSON"}}) {
    const auto file = parse_csv(text, "x.csv");
    ASSERT_FALSE(file) << text;
    EXPECT_EQ(file.error().text, "the file is " + std::string(what) + ", not CSV");
    EXPECT_THAT(file.error().hint, HasSubstr("t_s,F_ref_N,U_V"));
  }
  EXPECT_EQ(read("<t_s>,<F_ref_N>\n0,1\n1,2\n2,3\n", {{}, 10.0}).trace.channels.size(), 2u) << "names in angle brackets are no page";
}

TEST(ForeignFiles, WithoutAClockAndWithoutAForceBothAreTold) {
  const auto none = parse_csv("a,b\n1,2\n5,3\n", "x.csv"), forced = parse_csv("F_ref_N,b\n1,2\n5,3\n", "x.csv");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().to_text(), ::testing::AllOf(HasSubstr("no time column"), HasSubstr("none of them is the reference force either"), HasSubstr("--map NAME=F_ref_N")));
  ASSERT_FALSE(forced);
  EXPECT_THAT(forced.error().to_text(), ::testing::Not(HasSubstr("reference force")));
}

TEST(ForeignFiles, AClockOfDatesCountsSeconds) {
  const auto f = read(
      "timestamp,F,U\n2026-11-21 09:59:59.5,1,2\n2026-11-21 10:00:00.0,1,2\n2026-11-21 10:00:00.5,2,3\n");
  const auto& t = f.trace.time_bases[0].t_s;
  ASSERT_EQ(t.size(), 3u);
  EXPECT_NEAR(t[2] - t[0], 1.0, 1e-6);
}

TEST(ForeignFiles, AUnitMayStandBehindAComma) {
  const auto f = read("\"Time, s\",\"Force, mN\",\"Out, V\"\n0,1500,1\n1,2500,2\n");
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(f.trace.find("U")->value, (std::vector<double>{1, 2}));
}

TEST(ForeignFiles, ACounterOfRowsLeadsToTheirRate) {
  const auto counted = parse_csv("Sample,Force [N],Voltage [V]\n0,1,2\n1,1,2\n2,1,3\n3,1,3\n", "x.csv");
  ASSERT_FALSE(counted);
  EXPECT_THAT(counted.error().hint, ::testing::StartsWith("\"Sample\" counts the rows: give their rate, --rate HZ"));
  const auto other = parse_csv("Sample,Force [N],Voltage [V]\n0,1,2\n0.5,1,2\n1,1,3\n1.5,1,3\n", "x.csv");
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().hint, HasSubstr("--map Sample=t_s, or give --rate HZ"));
}

TEST(ForeignFiles, AnArduinoCountsMicrosecondsAndCodes) {
  const auto f = read("micros,force_N,adc\n0,1,500\n10000,2,600\n20000,3,700\n");
  EXPECT_NEAR(f.trace.time_bases[0].t_s[2], 0.02, 1e-12);
  ASSERT_TRUE(f.trace.find("U"));
  EXPECT_EQ(f.trace.find("U")->unit, "counts");
  EXPECT_THAT(f.notes, Contains(HasSubstr("errors are given in its own unit")));
}

TEST(ForeignFiles, AResistanceStandsForTheOutput) {
  const auto f = read("t_s,F_N,R_kohm\n0,1,5\n1,2,4\n");
  ASSERT_TRUE(f.trace.find("U"));
  EXPECT_EQ(f.trace.find("U")->value, (std::vector<double>{5000, 4000}));
}

TEST(ForeignFiles, GermanNamesAreKnown) {
  const auto f = read("Zeit;Kraft;Spannung\n0,0;1,5;2\n0,1;1,6;2,1\n");
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1.5, 1.6}));
  EXPECT_TRUE(f.trace.find("U"));
}

TEST(ForeignFiles, AColumnIsMappedByItsHeaderOrAsNotesWriteIt) {
  const char* text = "Time (s),Load A (mN),Load B (mN),Volts (V)\n0,1000,9,1\n1,2000,9,2\n";
  for (const char* name : {"Load A (mN)", "Load_A_mN"}) {
    CsvOptions options;
    options.column_map[name] = "F_ref_mN";
    EXPECT_EQ(read(text, options).trace.find("F_ref")->value, (std::vector<double>{1, 2})) << name;
  }
}

TEST(ForeignFiles, AssumedUnitsAreToldInOneNote) {
  const auto f = read("t,F,U\n0,1,2\n1,1,2\n");
  EXPECT_THAT(f.notes, ::testing::ElementsAre("no unit is given: t in s, F in N, U in V were assumed"));
}

TEST(ForeignFiles, WithoutAClockTheErrorSaysHowToGiveOne) {
  const auto f = parse_csv("row,F,U\n0,1,2\n1,1,2\n", "x.csv");
  ASSERT_FALSE(f);
  EXPECT_THAT(f.error().hint, HasSubstr("--map row=t_s"));
  EXPECT_THAT(f.error().hint, HasSubstr("--rate HZ"));
}

TEST(ForeignFiles, AHintWithANameThatAShellReadsItsOwnWayIsQuoted) {
  const auto f = parse_csv("row (n),F,U\n0,1,2\n1,1,2\n", "x.csv");
  ASSERT_FALSE(f);
  EXPECT_THAT(f.error().hint, HasSubstr("--map 'row (n)=t_s'"));
  std::string still = "Time (s),F,U\n";
  for (int i = 0; i < 100; ++i) still += "3,1,2\n";
  const auto g = parse_csv(still, "x.csv");
  ASSERT_FALSE(g);
  EXPECT_THAT(g.error().hint, HasSubstr("--map 'Time (s)=unused' --rate HZ"));
}

TEST(ForeignFiles, AVoltageThatNoConverterReadsIsTold) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + "," + std::to_string(40 * i) + "," + std::to_string(80 * i) + "\n";
  const auto f = read(text);
  EXPECT_THAT(f.notes, Contains("column \"U_V\" runs from 0 to 7920 V, which no converter reads; if it is in mV: --map U_V=U_mV"));
  EXPECT_THAT(f.notes, Contains(HasSubstr("--map F_ref_N=F_ref_mN")));
  CsvOptions options;
  options.column_map = {{"U_V", "U_mV"}, {"F_ref_N", "F_ref_mN"}};
  const auto mended = read(text, options);
  EXPECT_NEAR(mended.trace.find("U")->value[99], 7.92, 1e-9);
  EXPECT_THAT(mended.notes, ::testing::Not(Contains(HasSubstr("converter"))));
  EXPECT_TRUE(read("t_s,F_ref_N,U_V\n0,4000,9\n1,4448,10\n").notes.empty()) << "there are sensors for a thousand pounds";
}

TEST(ForeignFiles, AUnitThatAMapLosesIsTold) {
  CsvOptions options;
  options.column_map["load_g"] = options.column_map["Force (widgets)"] = options.column_map["F_GN"] = "F_ref_N";
  for (const char* name : {"load_g", "Force (widgets)", "F_GN"})
    EXPECT_THAT(read("t_s," + std::string(name) + ",U_V\n0,1,2\n1,2,3\n", options).notes, Contains(HasSubstr("is no unit known here: it was read as N"))) << name;
  options.column_map["g"] = "F_ref_N";
  options.column_map["t"] = "t_s";
  EXPECT_THAT(read("t,g,U_V\n0,1,2\n1,2,3\n", options).notes, Contains("\"g\" of column \"g\" is no unit known here: it was read as N"));
  EXPECT_THAT(read("t,g,U_V\n0,1,2\n1,2,3\n", options).notes, ::testing::Not(Contains(HasSubstr("\"t\" of"))));
  options.column_map["load_g"] = "F_ref_gf";
  options.column_map["F_dyn"] = "F_ref_N";
  for (const char* name : {"load_g", "F_dyn"})
    EXPECT_THAT(read("t_s," + std::string(name) + ",U_V\n0,1,2\n1,2,3\n", options).notes, ::testing::Not(Contains(HasSubstr("no unit known")))) << name;
  EXPECT_DOUBLE_EQ(read("t_s,F_uN,U_V\n0,1,2\n1,2,3\n").trace.find("F_ref")->value[1], 2e-6);
  EXPECT_DOUBLE_EQ(read("t_s,F_cN,U_V\n0,1,2\n1,2,3\n").trace.find("F_ref")->value[1], 2e-2);
}

TEST(ForeignFiles, OfTwoResistancesOneIsTakenOut) {
  const auto f = read("t_s,F_N,R1_kohm,R2_kohm\n0,1,2,3\n1,2,3,4\n");
  EXPECT_EQ(f.trace.find("U"), nullptr);
  EXPECT_THAT(column_map_advice(f.trace, "U", "V"), HasSubstr("R2_ohm=unused"));
}

// A force is no acceleration.
TEST(ForeignFiles, GramsOfAForceAreGramForce) {
  for (const char* name : {"F_ref_g", "Force (g)", "Force [g]", "F (g)", "weight_g", "Load_cell_g", "Fref_grams", "F_ref_gf"}) {
    const auto f = read("t_s," + std::string(name) + ",U_V\n0,1,2\n1,100,3\n");
    ASSERT_NE(f.trace.find("F_ref"), nullptr) << name;
    EXPECT_NEAR(f.trace.find("F_ref")->value[1], 0.980665, 1e-12) << name;
  }
  const auto below = read("t,Force,U\ns,g,V\n0,1,2\n1,100,3\n");
  ASSERT_NE(below.trace.find("F_ref"), nullptr);
  EXPECT_NEAR(below.trace.find("F_ref")->value[1], 0.980665, 1e-12);
  EXPECT_THAT(below.notes, ::testing::Not(Contains(HasSubstr("no unit known"))));
  for (const char* name : {"load_g", "F_g", "acc_g", "g"}) EXPECT_EQ(read("t_s," + std::string(name) + ",U_V\n0,1,2\n1,100,3\n").trace.find("F_ref"), nullptr) << name;
}

TEST(ForeignFiles, ANoteOfEveryRecordIsToldOnce) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "forcegate_foreign_folder";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  for (const char* name : {"a.csv", "b.csv", "c.csv"})
    std::ofstream(folder / name) << (std::string(name) == "c.csv" ? "t;F;U\n0;1;2\n1;1;2\n"
                                                                  : "t,F,U\n0,1,2\n1,1,2\n");
  for (const unsigned threads : {1u, 3u}) {
    CampaignOptions options;
    options.threads = threads;
    const auto c = read_campaign(folder, options);
    ASSERT_TRUE(c) << c.error().to_text();
    EXPECT_EQ(c->records.size(), 3u);
    EXPECT_EQ(c->records[2].name, "c");
    EXPECT_THAT(c->notes, Contains("every record: no unit is given: t in s, F in N, U in V were assumed"));
    EXPECT_THAT(c->notes, Contains("c: the separator is a semicolon"));
  }
  std::filesystem::remove_all(folder);
}

TEST(ForeignFiles, ACellThatIsNoNumberIsToldWhatItIs) {
  const auto hint = [](const std::string& text) {
    const auto file = parse_csv(text, "x.csv");
    EXPECT_FALSE(file) << text;
    return file ? std::string() : file.error().hint;
  };
  EXPECT_NE(hint("t_s,F_ref_N,U_V\n0,\xE2\x88\x92" "1.5,1\n0.1,\xE2\x88\x92" "1.4,2\n").find("U+2212"), std::string::npos);
  EXPECT_NE(hint_for_cell(std::string(60, '\0'), '.').find("cut or damaged"), std::string::npos);
  EXPECT_NE(hint("Time,Force (N),U (V)\n00:00.000,1,1\n00:00.050,1,2\n").find("[h]:mm:ss.000"), std::string::npos);
}

TEST(ForeignFiles, AnEmptyColumnOfASpreadsheetIsNoNote) {
  const auto file = parse_csv("t_s,F_ref_N,U_V,,\n0,1,1,,\n0.1,1,2,,\n0.2,,3,,\n", "x.csv");
  ASSERT_TRUE(file) << file.error().to_text();
  ASSERT_EQ(file->notes.size(), 1u) << file->notes.back();
  EXPECT_NE(file->notes[0].find("F_ref_N"), std::string::npos) << file->notes[0];
}

TEST(ForeignFiles, APointBesideDecimalCommasIsAnError) {
  const auto f = parse_csv("t_s;F_ref_N;U_mV\n0,0;0,5;993\n0,1;0,5;1.007\n", "x.csv");
  ASSERT_FALSE(f) << "1.007 is 1007 to one program and 1.007 to another";
  EXPECT_EQ(f.error().where, "x.csv:3:9");
  EXPECT_THAT(f.error().hint, HasSubstr("commas"));
}

TEST(ForeignFiles, TheHintForAClockNamesNoColumnThatIsSomethingElse) {
  const auto f = parse_csv("F_ref_N,U_V\n0,1\n1,2\n", "x.csv");
  ASSERT_FALSE(f);
  EXPECT_THAT(f.error().hint, ::testing::Not(HasSubstr("F_ref_N=t_s")));
  EXPECT_THAT(f.error().hint, HasSubstr("--rate HZ"));
}

TEST(ForeignFiles, SignsAndWordsOfUnitsAndColumnsAreKnown) {
  const auto f = read("Zeit [s],Kraft [N],U_V,Winkel [\u00b0],Temperature (\u00b0C),R (k\u03a9)\n0,1,2,180,21,5\n1,1,2,90,22,6\n");
  ASSERT_TRUE(f.trace.find("theta"));
  EXPECT_NEAR(f.trace.find("theta")->value[0], 3.14159265, 1e-8);
  ASSERT_TRUE(f.trace.find("temp"));
  EXPECT_EQ(f.trace.find("temp")->value[1], 22.0);
  ASSERT_TRUE(f.trace.find("R"));
  EXPECT_EQ(f.trace.find("R")->value[0], 5000.0);
  const auto latin = read("t_s,F_ref_N,U_V,Winkel [\xB0]\n0,1,2,180\n1,1,2,90\n");
  EXPECT_TRUE(latin.trace.find("theta")) << "the degree sign as one byte";
}

TEST(ForeignFiles, TheHumidityOfTheAirIsKnownByItsUsualNames) {
  for (const char* name : {"humidity_pct", "rh_pct", "RH_pct", "RH [%]", "Relative humidity (%)", "rh", "Luftfeuchte (%)"}) {
    const auto f = read("t_s,F_ref_N,U_V," + std::string(name) + "\n0,1,2,45\n1,1,2,46\n");
    ASSERT_TRUE(f.trace.find("humidity")) << name;
    EXPECT_NEAR(f.trace.find("humidity")->value[1], 0.46, 1e-12) << name;
    EXPECT_TRUE(unused_columns(f.trace).empty()) << name;
  }
}

TEST(ForeignFiles, LinesAboveTheHeaderAreSkippedWhereItIsUnmistakable) {
  const auto f = read("LabVIEW Measurement\nOperator,John\nRate,100\n\nt_s,F_ref_mN,U_V\n0,1500,2\n1,2500,3\n");
  ASSERT_TRUE(f.trace.find("F_ref"));
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(f.notes, Contains(HasSubstr("stand in line 5")));
  const auto after = parse_csv("Measurement\nt_s,F_ref_N,U_V\n0,1,2\n1,2,3\n2,x,3\n", "x.csv");
  ASSERT_FALSE(after);
  EXPECT_EQ(after.error().where, "x.csv:5:3") << "lines are counted from the top of the file";
  EXPECT_TRUE(read("t_s,F_ref_N,U_V,remark\n0,1,2,first\n1,2,3,second\n2,3,4,\n").trace.find("F_ref")) << "a column of text is no preamble";
}

TEST(ForeignFiles, AClockOfDayGoesOnAfterMidnight) {
  const auto f = read("Time,F,U\n23:59:59.0,1,2\n23:59:59.5,1,2\n00:00:00.0,2,3\n00:00:00.5,2,3\n");
  const auto& t = f.trace.time_bases[0].t_s;
  ASSERT_EQ(t.size(), 4u);
  EXPECT_NEAR(t[3] - t[0], 1.5, 1e-9);
  EXPECT_THAT(f.notes, Contains(HasSubstr("midnight")));
  EXPECT_FALSE(parse_csv("t_s,F,U\n500,1,2\n501,1,2\n0,2,3\n1,2,3\n", "x.csv")) << "two recordings in one file";
}

TEST(ForeignFiles, ADateBesideATimeOfDayIsPartOfTheClock) {
  const double day_s = *seconds_of_date("2026-11-21");
  const auto f = read("Date,Time,F,U\n2026-11-21,23:10:00.0,1,2\n2026-11-21,23:10:00.5,1,2\n2026-11-22,00:01:30.0,2,3\n,00:01:30.5,2,3\n");
  const auto& t = f.trace.time_bases[0].t_s;
  ASSERT_EQ(t.size(), 4u);
  EXPECT_NEAR(t[0], day_s + 83400.0, 1e-6);
  EXPECT_NEAR(t[2], day_s + 86400.0 + 90.0, 1e-6) << "samples may be as far apart as they like";
  EXPECT_NEAR(t[3] - t[2], 0.5, 1e-6) << "a date that is written where it changes";
  EXPECT_THAT(f.notes, Contains("columns \"Date\" and \"Time\" are the clock together: date and time of day"));
  EXPECT_THAT(f.notes, ::testing::Not(Contains(HasSubstr("left out"))));
  EXPECT_NEAR(read("Uhrzeit;Datum;F;U\n10:00:00,5;21.11.2026;1,5;2\n10:00:01,0;21.11.2026;1,5;2\n").trace.time_bases[0].t_s[0], day_s + 36000.5, 1e-6);
}

TEST(ForeignFiles, ADateThatStaysBehindMidnightIsThatOfTheBeginning) {
  const auto f = read("Date,Time,F,U\n2026/11/21,23:59:59.0,1,2\n2026/11/21,23:59:59.5,1,2\n2026/11/21,00:00:00.0,2,3\n");
  EXPECT_NEAR(f.trace.time_bases[0].t_s[2], *seconds_of_date("2026-11-22"), 1e-6);
  EXPECT_THAT(f.notes, Contains(HasSubstr("midnight")));
}

TEST(ForeignFiles, ADateThatIsNoPartOfTheClockIsLeftOut) {
  for (const char* text : {"t_s,Date,F,U\n0,2026-11-21,1,2\n1,2026-11-21,1,2\n", "Date,Time,F,U\n2026-11-21,10:00:00,1,2\nyesterday,10:00:01,1,2\n",
                           "Date,Time,F,U\n2026-11-21,2026-11-21 10:00:00,1,2\n2026-11-21,2026-11-21 10:00:01,1,2\n"})
    EXPECT_THAT(read(text).notes, Contains("column \"Date\" holds text and was left out")) << text;
  CsvOptions options;
  options.column_map["Date"] = "unused";
  const auto mapped = read("Date,Time,F,U\n2026-11-21,10:00:00,1,2\n2026-11-21,10:00:01,1,2\n", options);
  EXPECT_NEAR(mapped.trace.time_bases[0].t_s[0], 36000.0, 1e-6);
  EXPECT_THAT(mapped.mapped, ::testing::ElementsAre("Date"));
  EXPECT_THAT(read("Date,Time,F,U\n11/21/2026,10:00:00,1,2\n11/21/2026,10:00:01,1,2\n").notes, Contains(HasSubstr("write dates as 2024-05-31")));
}

TEST(ForeignFiles, AColumnOfTextMayBeMappedOut) {
  CsvOptions options;
  options.column_map["Remark"] = "unused";
  const auto f = read("t_s,F,U,Remark\n0,1,2,fine\n1,1,2,dropped it\n", options);
  EXPECT_THAT(f.mapped, ::testing::ElementsAre("Remark"));
  EXPECT_THAT(f.notes, ::testing::Not(Contains(HasSubstr("Remark"))));
  EXPECT_THAT(read("t_s,F,U,Remark\n0,1,2,fine\n1,1,2,dropped it\n").notes, Contains("column \"Remark\" holds text and was left out"));
}

TEST(ForeignFiles, AUnitBehindABlankCountsWhereItGoesWithTheName) {
  const auto f = read("Time ms,Force mN,U,Temperature °C\n0,1,2,21\n500,1,2,22\n");
  EXPECT_NEAR(f.trace.time_bases[0].t_s[1], 0.5, 1e-12);
  ASSERT_NE(f.trace.find("F_ref"), nullptr);
  EXPECT_NEAR(f.trace.find("F_ref")->value[0], 1e-3, 1e-12);
  ASSERT_NE(f.trace.find("temp"), nullptr);
  EXPECT_EQ(f.trace.find("temp")->unit, "C");
  EXPECT_EQ(meaning_of("Phase A").name, "Phase_A");
  EXPECT_EQ(meaning_of("Force A").unit.symbol, "");
}

}  // namespace
}  // namespace forcegate
