// Tables as oscilloscopes, spreadsheets and boards write them: what their clock is, and what to do where nobody can tell.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/units.h"
#include "hil/trace/campaign.h"
#include "hil/trace/columns.h"
#include "hil/trace/csv.h"
#include "hil/trace/csv_hints.h"
#include "tests/support/folder_test.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string refusal(std::string_view text, const CsvOptions& options = {}) {
  const auto file = parse_csv(text, "x.csv", options);
  EXPECT_FALSE(file);
  return file ? "" : file.error().to_text();
}

TEST(InstrumentFiles, UnitsMayBeWords) {
  for (const auto& [word, symbol] : {std::pair{"sec", "s"}, {"Seconds", "s"}, {"msec", "ms"}, {"Newton(s)", "N"}, {"volts", "V"}, {"VOLT", "V"}, {"lbs", "lbf"}}) {
    ASSERT_TRUE(find_unit(word)) << word;
    EXPECT_EQ(find_unit(word)->symbol, symbol) << word;
  }
  for (const char* none : {"section", "newtonian", "lbsx", "(s)"}) EXPECT_FALSE(find_unit(none)) << none;
  const auto f = read("Time (msec),Force (Newton(s)),Out [volts]\n0,1,2\n20,2,3\n40,3,4\n");
  EXPECT_THAT(f.trace.time_bases[0].t_s, ElementsAre(0.0, 0.02, 0.04));
  EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(1, 2, 3));
}

TEST(InstrumentFiles, AClockInCapitalsIsOne) {
  EXPECT_THAT(read("TIME_S,FORCE_N,VOLTAGE_V\n0,1,2\n0.5,2,3\n").trace.time_bases[0].t_s, ElementsAre(0.0, 0.5));
  EXPECT_THAT(read("TIME [MS],FORCE_N,VOLTAGE_V\n0,1,2\n500,2,3\n").trace.time_bases[0].t_s, ElementsAre(0.0, 0.5));
  EXPECT_EQ(read("t_s,F_N,G_S\n0,1,2\n1,2,3\n").trace.find("U")->unit, "S") << "siemens stay siemens";
}

TEST(InstrumentFiles, AnOscilloscopeTellsStartAndIncrement) {
  const auto f = read("X,CH1,CH2,Start,Increment\nSequence,VOLT,VOLT,-1.0,2.0e-2\n0,1,5,,\n1,2,6,,\n2,3,7,,\n", {{{"CH1_V", "F_ref_N"}}, 0.0});
  EXPECT_THAT(f.trace.time_bases[0].t_s, ElementsAre(-1.0, -0.98, -0.96));
  ASSERT_EQ(f.trace.channels.size(), 2u);
  EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(1, 2, 3));
  EXPECT_THAT(f.trace.find("U")->value, ElementsAre(5, 6, 7));
  EXPECT_THAT(f.notes, Contains(HasSubstr("oscilloscope")));
  EXPECT_THAT(f.notes, Not(Contains(HasSubstr("misses"))));
}

TEST(InstrumentFiles, WordsBetweenNamesAndUnitsAreSkipped) {
  for (const char* words : {",ATI Nano17,FlexiForce", "clock,ATI Nano17,FlexiForce"}) {
    const auto f = read("Zeit,Referenz,Sensor\n" + std::string(words) + "\n[s],[mN],[V]\n0,1500,2\n1,2500,3\n");
    ASSERT_TRUE(f.trace.find("F_ref")) << words;
  }
}

TEST(InstrumentFiles, WordsBelowTheNamesAreToldAndLinesStillCounted) {
  const std::string head = "Time,Force,Sensor\n,ATI Nano17,FlexiForce\n[s],[mN],[V]\n0,1500,2\n1,2500,3\n";
  const auto f = read(head);
  EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(1.5, 2.5));
  EXPECT_THAT(f.notes, Contains(HasSubstr("line 2 holds words")));
  EXPECT_THAT(refusal(head + "2,oops,3\n"), HasSubstr("x.csv:6:3"));
  EXPECT_THAT(refusal("Time,Force,Sensor\na,b,c\nd,e,f\n"), HasSubstr("no cell of the first line below the names is a number"));
}

TEST(InstrumentFiles, WhereNoClockIsKnownTheColumnsOfTextAreNamed) {
  EXPECT_THAT(refusal("DateTime,Force_N,Vout_V\n11/20/2026 10:00:00.000 AM,1,2\n11/20/2026 10:00:01.000 AM,2,3\n"),
              AllOf(HasSubstr("DateTime (\"11/20/2026 10:00:00.000 AM\")"), HasSubstr("which number is the month is told by 11/20/2026, the first, but not by every date of this form"), HasSubstr("2024-05-31T10:31:07")));
  EXPECT_THAT(refusal("DateTime,Force_N,Vout_V\n11/20/2026 10:00:00.000 AM,1,2\n11/20/2026 10:00:01.000 AM,2,3\n", {{{"DateTime", "t_s"}}, 0.0}),
              HasSubstr("which number is the month"));
  EXPECT_THAT(refusal("X,CH1,Begin,Step\nSequence,VOLT,0,0.02\n0,1,,\n"), AllOf(HasSubstr("X (\"Sequence\"), CH1 (\"VOLT\")"), HasSubstr("if line 2 is no row, take it out")));
}

TEST(InstrumentFiles, DaysOfASpreadsheetAreAdvisedAsDays) {
  const std::string file = "Date,Force_N,Vout_V\n46346.4,1,2\n46346.4000002,2,3\n46346.4000004,3,4\n";
  EXPECT_THAT(refusal(file), HasSubstr("--map Date=t_days"));
  EXPECT_THAT(read(file, {{{"Date", "t_s"}}, 0.0}).notes, Contains(HasSubstr("if it counts days, as a spreadsheet does: --map Date=t_days")));
  EXPECT_THAT(refusal("Date,Force_N,Vout_V\n0,1,2\n0.5,2,3\n"), HasSubstr("--map Date=t_s"));
  EXPECT_THAT(refusal("Stamp (ticks),Force_N,Vout_V\n0,1,2\n0.5,2,3\n"), HasSubstr("where \"ticks\" means seconds"));
}

TEST(InstrumentFiles, ACounterOf32BitsGoesOn) {
  const auto f = read("micros,Force_N,adc\n4294927296,1,2\n4294947296,2,3\n4294967295,3,4\n19999,4,5\n39999,5,6\n");
  const auto& t = f.trace.time_bases[0].t_s;
  ASSERT_EQ(t.size(), 5u);
  EXPECT_NEAR(t[3] - t[2], 0.02, 1e-9);
  EXPECT_THAT(f.notes, Contains(HasSubstr("passes 2^32")));
  EXPECT_THAT(refusal("micros,Force_N,adc\n4294927296,1,2\n4294947296,2,3\n4294967295,2,3\n900000000,3,4\n900020000,4,5\n"), HasSubstr("jumps back")) << "steps that far are two recordings";
  EXPECT_THAT(refusal("micros,Force_N,adc\n1000000,1,2\n1020000,2,3\n1040000,1,2\n0,4,5\n20000,4,5\n"), HasSubstr("jumps back")) << "a board that began anew";
}

TEST(InstrumentFiles, UnitsBelowTitlesMayNameTheFormOfTheStamps) {
  const std::string rows = "10:00:00.000;5;0.5\n10:00:00.050;6;0.6\n10:00:00.100;7;0.7\n";
  for (const char* titles : {"No;12\n", "Protokoll;Z2.5;;\nWho;M\xC3\xBCller;;\n\n"})
    for (const char* form : {"hh:mm:ss", "[HH:MM:SS.000]", "hh:mm:ss,fff"}) {
      const auto f = read(std::string(titles) + "time;force;voltage\n" + form + ";kgf;V\n" + rows);
      ASSERT_NE(f.trace.find("F_ref"), nullptr) << titles << form;
      EXPECT_NEAR(f.trace.find("F_ref")->value[0], 5 * 9.80665, 1e-9);
      EXPECT_NEAR(f.trace.time_bases[0].t_s[1] - f.trace.time_bases[0].t_s[0], 0.05, 1e-9);
    }
  EXPECT_THAT(refusal("mm;12\ntime;force;voltage\n10:00:00;5;0.5\n10:00:01;6;0.6\n" "10:00:02;x;0.6\n"), HasSubstr("is not a number")) << "and a name is none";
}

TEST(InstrumentFiles, UnitsAreReadInWindows1252AndBehindTheWordIn) {
  const auto f = read("Zeit;Kraft;Spannung;Temperatur\nin s;in N;in V;\xB0" "C\n0;1;0.5;21\n0.1;2;0.6;22\n");
  ASSERT_NE(f.trace.find("F_ref"), nullptr);
  ASSERT_NE(f.trace.find("temp"), nullptr);
  EXPECT_EQ(f.trace.find("temp")->value[1], 22.0);
  EXPECT_THAT(refusal("Zeit;Kraft\nPr\xFC" "fer;M\xFCller\n"), HasSubstr("Pr\xC3\xBC" "fer;M\xC3\xBCller"));
}

TEST(InstrumentFiles, UnitsInBracketsMayStandInQuotes) {
  for (const char* units : {"\"(s)\",\"(mN)\",\"(V)\"", "\"[s]\" ,\" [mN]\",\"[ V ]\""}) {
    const auto f = read("\"Time\",\"Load\",\"Voltage\"\n" + std::string(units) + "\n\"0.0\",\"1500\",\"1\"\n\"0.1\",\"1600\",\"1.2\"\n");
    ASSERT_NE(f.trace.find("F_ref"), nullptr) << units;
    EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(1.5, 1.6));
  }
}

TEST(InstrumentFiles, AnHourThatIsSkippedAtNightIsThatOfSummerTime) {
  const auto skips = [](const std::string& from, const std::string& to, const std::string& zone = "") {
    std::string rows = "time,Force_N,U_V\n";
    for (int i = 0; i < 80; ++i) {
      const int s = i < 40 ? 20 + i : i - 40;
      rows += (i < 40 ? from : to) + (s < 10 ? "0" : "") + std::to_string(s) + zone + ",1," + std::to_string(i) + "\n";
    }
    return rows;
  };
  const std::string hour = refusal(skips("2026-03-29T01:59:", "2026-03-29T03:00:"));
  EXPECT_THAT(hour, AllOf(HasSubstr("skips an hour, from 2026-03-29T01:59:59.000 to 2026-03-29T03:00:00.000"), HasSubstr("x.csv:42"), HasSubstr("beginning of summer time")));
  EXPECT_THAT(refusal(skips("01:59:", "03:00:")), HasSubstr("summer time"));
  read(skips("2026-03-29T01:59:", "2026-03-29T03:00:", "Z"));  // a pause: its stamps tell their zone
  read(skips("2026-03-28T01:59:", "2026-03-28T03:00:"));       // a Saturday
  read(skips("2026-03-29T09:59:", "2026-03-29T11:00:"));       // by day
  read(skips("2026-03-29T00:59:", "2026-03-29T03:00:"));       // two hours
}

TEST(InstrumentFiles, StampsHaveAZoneAllOfThemOrNone) {
  const std::string rows = "time,Force_N,U_V\n2026-03-01T10:00:00Z,1,2\n2026-03-01T10:00:01+00:00,1,3\n";
  read(rows);
  EXPECT_THAT(refusal(rows + "2026-03-01T10:00:02,1,3\n"), AllOf(HasSubstr("has no zone, and the stamps above it have one"), HasSubstr("x.csv:4:1")));
  EXPECT_THAT(refusal("time,Force_N,U_V\n2026-03-01T10:00:00,1,2\n2026-03-01T10:00:01Z,1,3\n"), HasSubstr("has a zone, and the stamps above it have none"));
}

TEST(InstrumentFiles, ATimeThatDoesNotExistIsNoStamp) {
  for (const char* stamp : {"2025-02-31T12:00:00", "2025-02-29 12:00:00", "31.04.2025 12:00:00", "2025-03-01T12:60:00", "12:00:61.000", "24:00:00.000"})
    EXPECT_THAT(refusal("time,Force_N,U_V\n" + std::string(stamp) + ",1,2\n2026-01-01T00:00:01,1,2\n"), AllOf(HasSubstr(stamp), HasSubstr("there is no such time"))) << stamp;
  EXPECT_THAT(refusal("time,Force_N,U_V\n2025-02-28 12:00:00,1,2\n2025-02-31 12:00:00,1,2\n"), AllOf(HasSubstr("x.csv:3:1"), HasSubstr("there is no such time")));
  read("time,Force_N,U_V\n2024-02-29 12:00:00,1,2\n2024-02-29 12:00:01,1,2\n");
}

TEST(InstrumentFiles, SwappedNeighboursAreSortedAndAFileFromItsEndIsNot) {
  std::string swapped = "t_s,Force_N,U_V\n", backwards = swapped;
  for (int i = 0; i < 40; ++i) swapped += std::to_string(i ^ 1) + ",1," + std::to_string(i) + "\n", backwards += std::to_string(40 - i) + ",1,2\n";
  EXPECT_THAT(read(swapped).notes, Contains("20 rows were out of order; sorted by time"));
  EXPECT_THAT(refusal(backwards), HasSubstr("the clock runs backwards, from 40 s down to 1 s"));
}

TEST(InstrumentFiles, NamesThatDifferInCapitalsAloneAreProposed) {
  EXPECT_THAT(refusal("T_S,f_ref_n,u_v\n0,1,2\n0.05,1.2,3\n0.15,1,2\n"), HasSubstr("--map T_S=t_s --map f_ref_n=F_ref_N --map u_v=U_V"));
  EXPECT_EQ(meant_but_for_capitals("U_V"), "");
  EXPECT_EQ(meant_but_for_capitals("sensor"), "");
}

TEST(InstrumentFiles, TheDateThatTellsItsMonthIsWrittenAsItIsRead) {
  EXPECT_THAT(hint_for_cell("3/14/2025 11:55:00 AM", '.'), AllOf(HasSubstr("is told by 3/14/2025, the first"), HasSubstr("2025-03-14")));
  EXPECT_THAT(hint_for_cell("14/3/2025 11:55:00", '.'), AllOf(HasSubstr("the second"), HasSubstr("2025-03-14")));
  EXPECT_THAT(hint_for_cell("03/04/2025", '.'), HasSubstr("is not told by 03/04/2025"));
}

TEST(InstrumentFiles, AnotherSeparatorAndASurplusCellAreToldAsWhatTheyAre) {
  const std::string head = "t_s,F_ref_N,U_V\n0.00,1.1,2.0\n0.05,1.2,2.1\n";
  EXPECT_THAT(refusal(head + "0.10;1.3;2.2\n"), AllOf(HasSubstr("parted by a semicolon, those above it by a comma"), HasSubstr("x.csv:4")));
  EXPECT_THAT(refusal("t_s;F_ref_N;U_V\n0.00,1.1,2.0\n"), HasSubstr("parted by a comma, those above it by a semicolon"));
  EXPECT_THAT(refusal(head + "0.10,1.3,2.2,7.0,8.0\n"), AllOf(HasSubstr("one cell for each column"), Not(HasSubstr("decimal commas"))));
  EXPECT_THAT(refusal(head + "0,10,1,3,2,2\n"), HasSubstr("decimal commas"));
  EXPECT_THAT(refusal(head + "t_s,load,note\n0,1,2\n"), HasSubstr("where another table begins"));
}

TEST(InstrumentFiles, AWordForNoValueIsNoSizeOfTheOutput) {
  std::string rows = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 400; ++i) rows += std::to_string(0.05 * i) + ",1," + (i % 40 == 0 ? "-9999" : std::to_string(2.0 + 0.001 * i)) + "\n";
  EXPECT_THAT(read(rows).notes, Not(Contains(HasSubstr("U_mV"))));
}

TEST(InstrumentFiles, AClockThatGoesBackAnHourIsToldInItsStamps) {
  std::string rows = "time,Force_N,U_V\n";
  for (int i = 0; i < 40; ++i) rows += "2026-10-25T02:59:" + std::to_string(20 + i) + ",1," + std::to_string(i) + "\n";
  const std::string hour = refusal(rows + "2026-10-25T02:00:00,1,2\n2026-10-25T02:00:01,1,3\n");
  EXPECT_THAT(hour, AllOf(HasSubstr("from 2026-10-25T02:59:59.000 to 2026-10-25T02:00:00.000 in line 42"), HasSubstr("summer time")));
  EXPECT_THAT(refusal(rows + "2026-10-25T02:10:00,1,2\n"), Not(HasSubstr("summer time")));
  EXPECT_THAT(refusal("time_s,Force_N,U_V\n6997,1,2\n6998,2,2\n6999,1,4\n7000,1,2\n7001,1,2\n3402,1,3\n"), AllOf(HasSubstr("from 7001 s to 3402 s"), Not(HasSubstr("summer time"))));
}

class MixedOutputs : public FolderTest {};

TEST_F(MixedOutputs, OneCampaignIsOneOutput) {
  std::string volts = "t_s,F_ref_N,U_V\n", ohms = "t_s,F_ref_N,R_kohm\n";
  for (int i = 0; i < 40; ++i) {
    const std::string row = std::to_string(i) + "," + std::to_string(1.0 + 0.1 * (i % 7)) + ",";
    volts += row + std::to_string(2.0 + 0.2 * (i % 7)) + "\n";
    ohms += row + std::to_string(50.0 / (1.0 + 0.1 * (i % 7))) + "\n";
  }
  put("a.csv", volts);
  put("b.csv", ohms);
  put("c.csv", "t_s,F_ref_N,U_mV\n" + volts.substr(volts.find('\n') + 1));
  const auto campaign = read_campaign(folder_);
  ASSERT_FALSE(campaign);
  EXPECT_THAT(campaign.error().to_text(), AllOf(HasSubstr("the output of b is in ohm, that of the others in V"), HasSubstr("b.csv:1")));
  std::filesystem::remove(folder_ / "b.csv");
  EXPECT_TRUE(read_campaign(folder_)) << "millivolts are volts";
}

}  // namespace
}  // namespace forcegate
