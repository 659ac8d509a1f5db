// Text as loggers, scopes and spreadsheets write it: read rightly, or refused with the place and the way to mend it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hil/trace/campaign.h"
#include "hil/trace/convert.h"
#include "hil/trace/csv.h"
#include "hil/trace/csv_hints.h"
#include "hil/trace/date_time.h"
#include "tests/support/folder_test.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

Error refuse(std::string_view text) {
  const auto file = parse_csv(text, "x.csv");
  EXPECT_FALSE(file);
  return file ? Error{} : file.error();
}

std::vector<double> force(const TraceFile& file) {
  const Channel* channel = file.trace.find("F_ref");
  return channel != nullptr ? channel->value : std::vector<double>{};
}

// 40 rows of 0.01 s, 1.5 N and U rising by 0.01 V.
std::string rows_of(int n = 40) {
  std::string out;
  for (int i = 0; i < n; ++i) {
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,1.5,%.2f\n", 0.01 * i, 3.0 + 0.01 * i);
    out += row;
  }
  return out;
}

std::string utf16(std::string_view text, bool big, bool mark) {
  std::string out = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    const char wide[2] = {big ? '\0' : c, big ? c : '\0'};
    out.append(wide, 2);
  }
  return out;
}

TEST(LoggerFiles, Utf16IsRead) {
  const std::string text = "t_s\tF_ref_N\tU_V\r\n0\t1.5\t2\r\n1\t2.5\t3\r\n";
  for (const bool big : {false, true})
    for (const bool mark : {false, true}) {
      const auto f = read(utf16(text, big, mark));
      EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5}));
      EXPECT_THAT(f.notes, Contains("the text is UTF-16"));
    }
  const std::string degree("\xFF\xFE\xB0\0\x3C\xD8\x0D\xDF", 8);  // a degree sign and a letter of two units
  EXPECT_THAT(refuse(degree).text, HasSubstr("no rows"));
}

TEST(LoggerFiles, Utf32IsReadAndToldOnce) {
  for (const bool big : {false, true}) {
    std::string wide = big ? std::string("\0\0\xFE\xFF", 4) : std::string("\xFF\xFE\0\0", 4);
    for (const char c : std::string_view("t_s\tF_ref_N\tU_V\n0\t1.5\t2\n1\t2.5\t3\n")) {
      const std::string zeros(3, '\0');
      wide += big ? zeros + c : c + zeros;
    }
    const auto f = read(wide);
    EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5}));
    EXPECT_THAT(f.notes, ::testing::ElementsAre("the text is UTF-32", "the separator is a tab"));
  }
}

TEST(LoggerFiles, LinesThatEndInCarriageReturnsAloneAreRead) {
  EXPECT_EQ(force(read("t_s,F_ref_N\r0,1.5\r1,2.5\r")), (std::vector<double>{1.5, 2.5}));
  const fs::path path = fs::path(::testing::TempDir()) / ("forcegate_cr_" + std::to_string(::getpid()) + ".csv");
  std::ofstream(path, std::ios::binary) << "t_s,F_ref_N\r0,1.5\r1,2.5\r";
  const auto file = read_csv(path);
  fs::remove(path);
  ASSERT_TRUE(file) << file.error().to_text();
  EXPECT_EQ(force(*file), (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(file->notes, Contains("the lines end in CR alone"));
}

TEST(LoggerFiles, ALastNumberThatWasCutIsDroppedWithItsRow) {
  const std::string whole = "t_s,F_ref_N,U_V\n" + rows_of();
  for (const char* last : {"0.40,1.5,3.", "0.40,1.5,", "0.40,1.5,-", "0.40,1.5,0", "0.40,1.5,34"}) {
    const auto f = read(whole + last);
    EXPECT_EQ(f.trace.size(), 40u) << last;
    EXPECT_THAT(f.notes, Contains(HasSubstr("cut short"))) << last;
    EXPECT_THAT(f.notes, Not(Contains(HasSubstr("misses")))) << last;
  }
  const auto fits = read(whole + "0.40,1.5,3.4");
  EXPECT_EQ(fits.trace.size(), 41u) << "many programs write no line end behind the last row";
  EXPECT_TRUE(fits.notes.empty());
  EXPECT_EQ(read("t_s,F_ref_N,U_V\n" + rows_of(3) + "0.03,1.5,30").trace.size(), 4u) << "too few rows to tell";
  EXPECT_EQ(read(whole + "0.40,1.5,34\n").trace.size(), 41u) << "a line end says that it is whole";
}

TEST(LoggerFiles, NamesInACommentAboveTheRowsAreTheHeader) {
  const auto f = read("# bench 2\n# t_s,F_ref_N,U_V\n0,1.5,2\n1,2.5,3\n");
  EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(f.notes, Contains(HasSubstr("comment above the first row")));
  EXPECT_EQ(force(read("# t_s F_ref_N U_V\n0.0 1.5 2\n0.1 2.5 3\n")), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(refuse("# t_s,F_ref_N\n0,1\n1,oops\n").where, "x.csv:3:3");
  EXPECT_THAT(refuse("# my bench, 3 N\n0,1,2\n1,2,3\n").text, HasSubstr("numbers, not column names"));
}

TEST(LoggerFiles, DecimalCommasAndAColumnOfWordsHideNoHeaderAboveThem) {
  EXPECT_EQ(force(read("# t_s;F_ref_N;U_V\n0,0;1,5;2,1\n0,1;2,5;3,1\n")), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(force(read("# t_s,F_ref_N,U_V,state\n0,1.5,2,idle\n1,2.5,3,loaded\n")), (std::vector<double>{1.5, 2.5}));
  const auto titled = read("Run sheet\nt_s,F_ref_N,U_V,state\n0,1.5,2,idle\n1,2.5,3,loaded\n");
  EXPECT_EQ(force(titled), (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(titled.notes, Contains(HasSubstr("stand in line 2")));
}

TEST(LoggerFiles, ARowThatLacksACellBetweenBlanksIsLeftOutWhereFewDo) {
  const auto rows = [](int lacking) {
    std::string out = "t_s F_ref_N U_V\n";
    for (int i = 0; i < 200; ++i) out += std::to_string(0.01 * i) + " 1.5" + (i >= 100 && i < 100 + lacking ? "\n" : " 3.5\n");
    return out;
  };
  const auto f = read(rows(3));
  EXPECT_EQ(f.trace.size(), 197u);
  EXPECT_THAT(f.notes, Contains(HasSubstr("3 lines lack a cell between blanks, which one nobody can tell: left out (the first is line 102)")));
  const Error e = refuse(rows(20));
  EXPECT_EQ(e.where, "x.csv:102:13");
  EXPECT_THAT(e.hint, HasSubstr("nan"));
}

TEST(LoggerFiles, ALineOfWordsBetweenNamesAndUnitsMayHaveOneCell) {
  EXPECT_EQ(force(read("Time,Force,Voltage\naveraged over one reading\nms,mN,V\n0,1500,2\n100,2500,3\n")), (std::vector<double>{1.5, 2.5}));
  EXPECT_EQ(force(read("Time,Force,Voltage,Step\naveraged over one reading\nms,mN,V,\n0,1500,2,7\n100,2500,3,8\n")), (std::vector<double>{1.5, 2.5})) << "a column without a unit";
}

TEST(LoggerFiles, TitlesAboveTheNamesAreSkippedThoughTheyHaveAsManyCells) {
  const auto f = read("Sensor,ATI,FlexiForce\nRate,100,Hz\nTime (s),Force (mN),Output (V)\n0,1500,2\n1,2500,3\n");
  EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(f.notes, Contains(HasSubstr("stand in line 3")));
}

TEST(LoggerFiles, NamesThatStandAgainAreSkipped) {
  const auto f = read("time,force,U_V\ns,mN,V\n0,1500,2\ntime,force,U_V\ns,mN,V\n1,2500,3\ntime,force,U_V\n2,500,3\n");
  EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5, 0.5}));
  EXPECT_THAT(f.notes, Contains(HasSubstr("stand again in line 4 and 1 more")));
  const std::string twice = "t_s,F_ref_N,U_V\n" + rows_of() + "t_s,F_ref_N,U_V\n" + rows_of();
  const auto e = refuse(twice);
  EXPECT_THAT(e.text, HasSubstr("jumps back from 0.39 s to 0 s"));
  EXPECT_EQ(e.where, "x.csv:43");
}

TEST(LoggerFiles, AColumnThatIsEmptyUntilSomebodyWritesIntoItHoldsText) {
  const auto f = read("t_s,F_ref_N,event\n0,1,\n1,2,\n2,3,touched\n3,4,\n");
  EXPECT_EQ(force(f), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_THAT(f.notes, Contains("column \"event\" holds text and was left out"));
  EXPECT_THAT(refuse("t_s,F_ref_N\n0,\n1,\n2,touched\n").where, "x.csv:4:3") << "a force is no remark";
}

TEST(LoggerFiles, AUnitThatIsNotKnownStaysWithItsColumn) {
  const auto f = read("Time,Force,Out\n[s],[widgets],[mV]\n0,1500,2\n1,2500,3\n");
  EXPECT_EQ(f.trace.find("F_ref"), nullptr);
  EXPECT_NE(f.trace.find("Force_(widgets)"), nullptr);
  EXPECT_THAT(f.notes, Contains("no unit known here: \"widgets\" of column \"Force\""));
}

TEST(LoggerFiles, ALineOfUnitsMayRepeatWhatTheNamesSay) {
  for (const char* text : {"t_s,F_mN,U_V\ns,mN,V\n0,1500,2\n1,2500,3\n", "Time (s),Force (mN),Output (V)\nsec,mN,volts\n0,1500,2\n1,2500,3\n", "t_s,F_mN,U_V\n[s],-,[V]\n0,1500,2\n1,2500,3\n"}) {
    const auto f = read(text);
    EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5})) << text;
    EXPECT_EQ(f.trace.time_bases[0].t_s, (std::vector<double>{0, 1})) << text;
    EXPECT_TRUE(f.trace.find("U")) << text;
  }
  EXPECT_EQ(force(read("t,F_m,U_V\ns,N,V\n0,1.5,2\n1,2.5,3\n")), (std::vector<double>{1.5, 2.5})) << "the measured force is not in metres";
}

TEST(LoggerFiles, ALineOfUnitsThatContradictsTheNamesIsAnError) {
  for (const auto& [text, where] : {std::pair{"t_s,F_N,U_V\ns,mN,V\n0,1,2\n1,2,3\n", "x.csv:2:3"}, {"t_s,F_N,U_V\nms,N,V\n0,1,2\n1,2,3\n", "x.csv:2:1"},
                                    {"t_s,F_N,U_V\ns,V,N\n0,1,2\n1,2,3\n", "x.csv:2:3"}, {"Time (s),Force (N),Output (V)\ns,N,mV\n0,1,2\n1,2,3\n", "x.csv:2:5"}}) {
    const Error e = refuse(text);
    EXPECT_EQ(e.where, where) << text;
    EXPECT_THAT(e.text, HasSubstr("has its unit in its name, and the line of units says")) << text;
    EXPECT_THAT(e.hint, HasSubstr("mend the one that is wrong")) << text;
  }
}

TEST(LoggerFiles, LabViewMeasurementsAreRead) {
  const std::string head =
      "LabVIEW Measurement\t\nSeparator\tTab\nX_Columns\tOne\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t3\t\nY_Unit_Label\tmN\tmV\t\n"
      "X_Dimension\tTime\tTime\t\nX0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\nDelta_X\t0.100000\t0.100000\t\n"
      "***End_of_Header***\t\t\t\nX_Value\tForce\tVoltage\tComment\n";
  const auto f = read(head + "0.0\t1500\t2000\n0.1\t2500\t3000\ttouched\n0.2\t500\t3000\n");
  EXPECT_EQ(force(f), (std::vector<double>{1.5, 2.5, 0.5}));
  ASSERT_TRUE(f.trace.find("U"));
  EXPECT_EQ(f.trace.find("U")->value[1], 3.0);
  CsvOptions options;
  options.assumed_rate_Hz = 100.0;
  options.column_map["X_Value"] = "unused";
  EXPECT_EQ(force(read(head + "\t1500\t2000\n\t2500\t3000\n", options)), (std::vector<double>{1.5, 2.5})) << "no X column is written";
}

TEST(LoggerFiles, OfSeveralVoltagesNoCurrentIsTheOutput) {
  const auto f = read("t_s,F_ref_N,motor_current_mA,left_V,right_V\n0.0,1,5,1,2\n0.1,2,6,2,3\n");
  EXPECT_FALSE(f.trace.find("U"));
  EXPECT_TRUE(read("t_s,F_ref_N,sensor_current_mA\n0.0,1,5\n0.1,2,6\n").trace.find("U")) << "a sensor that is read as a current";
}

TEST(LoggerFiles, TwoColumnsOfOneNameAreRefused) {
  CsvOptions options;
  options.column_map = {{"left_V", "U_V"}, {"right_V", "U_V"}};
  const auto twice = parse_csv("t_s,F_ref_N,left_V,right_V\n0.0,1,1,2\n0.1,2,2,3\n", "f.csv", options);
  ASSERT_FALSE(twice);
  EXPECT_THAT(twice.error().to_text(), HasSubstr("columns \"left_V\" and \"right_V\" are both mapped to U"));
}

TEST(LoggerFiles, QuotedDecimalCommasAreReadBesideCommas) {
  EXPECT_EQ(force(read("t_s,F_ref_N\n\"0,0\",\"1,50\"\n\"0,1\",\"2,5\"\n")), (std::vector<double>{1.5, 2.5}));
  EXPECT_THAT(refuse("t_s,F_ref_N\n0,\"1,500\"\n1,\"2,500\"\n").hint, HasSubstr("write 1500 and not 1,500"));
}

TEST(LoggerFiles, TheFirstNumberWithDecimalsTellsWhatPartsThem) {
  const auto f = read("Zeit [s];Kraft [N];Spannung [V]\n0;0;0\n1;;2\n1,01;1,5;2,2\n2,02;1,75;2\n");
  EXPECT_THAT(force(f), ElementsAre(0, testing::IsNan(), 1.5, 1.75));
  EXPECT_THAT(f.notes, Contains("the decimals are commas"));
  EXPECT_THAT(force(read("t_s,F_ref_N\n0,\n1,2\n\"1,5\",\"2,5\"\n")), ElementsAre(testing::IsNan(), 2, 2.5));
  EXPECT_THAT(force(read("time;F_ref_N\n10:31:07.25;0\n10:31:07.75;0,5\n10:31:08.25;1\n")), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(force(read("t_s;F_ref_N\n0;0\n1;1,234\n")), ElementsAre(0, 1.234));
}

TEST(LoggerFiles, ACommaBelowAPointOrAThousandBelowHundredsIsRefused) {
  EXPECT_THAT(refuse("t_s;F_ref_N\n0;1\n1;1.5\n2;1,5\n").hint, HasSubstr("decimals of this file are points"));
  EXPECT_EQ(refuse("t_s;F_ref_N\n0;998\n1;999\n2;1,000\n").hint,
            "write 1000 and not 1,000: nothing may part the thousands, and where it is no thousand, the decimals need a point");
  EXPECT_THAT(refuse("t_s;F_ref_N\n0;0\n1;1,5\n2;1.5\n").hint, HasSubstr("decimals of this file are commas"));
}

TEST(LoggerFiles, TimesOfDayWithOneDigitAndHalfDaysAreRead) {
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("9:05:00.5"), 32700.5);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("9:05:00 PM"), 75900.0);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("12:00:01 am"), 1.0);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("2026/11/21 10:00:00"), *seconds_of_stamp("2026-11-21 10:00:00"));
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("21.11.2026 10:00"), *seconds_of_stamp("2026-11-21 10:00:00"));
  for (const char* text : {"10:00", "13:00:00 PM", "0:05:00 AM", "9:05:00 XM", "9:5:00", "2026/11/21"}) EXPECT_FALSE(seconds_of_stamp(text)) << text;
}

TEST(LoggerFiles, AnOverrangeOfAScopeIsMissing) {
  const auto f = read("t_s,F_ref_N\n0,1\n1,\xE2\x88\x9E\n2,-\xE2\x88\x9E\n");
  EXPECT_THAT(f.notes, Contains(HasSubstr("misses 2 of 3")));
}

TEST(LoggerFiles, HintsSayWhatIsWrongWithTheCell) {
  EXPECT_EQ(hint_for_cell("1,000.64", '.'), "write 1000.64 and not 1,000.64: nothing may part the thousands");
  EXPECT_THAT(hint_for_cell("-1'234'567.5", '.'), HasSubstr("write -1234567.5"));
  EXPECT_THAT(hint_for_cell("1 000,5", ','), HasSubstr("write 1000,5"));
  EXPECT_EQ(hint_for_cell("0 598,79", ','), "write 598,79 and not 0 598,79: nothing may part the thousands");
  EXPECT_THAT(hint_for_cell("-0 000,5", ','), HasSubstr("write -0,5 and"));
  EXPECT_THAT(hint_for_cell("0 000", '.'), HasSubstr("write 0 and"));
  EXPECT_THAT(hint_for_cell("1.007", ','), HasSubstr("decimals of this file are commas"));
  EXPECT_THAT(hint_for_cell("0.000", ','), HasSubstr("decimals of this file are commas"));
  EXPECT_THAT(hint_for_cell("0,5", '.'), HasSubstr("decimals of this file are points"));
  EXPECT_THAT(hint_for_cell("4.1 V", '.'), HasSubstr("write the number alone"));
  EXPECT_THAT(hint_for_cell("OVERLOAD", '.'), HasSubstr("leave the cell empty"));
  EXPECT_THAT(refuse("t_s,F_ref_N,U_V\n" + rows_of() + "touched the table\n" + rows_of()).hint, HasSubstr("put # before it"));
  const auto words = refuse("time,force,voltage\n0 s,1 N,4 V\n1 s,1 N,4 V\n");
  EXPECT_EQ(words.where, "x.csv:2:1");
  EXPECT_THAT(words.hint, HasSubstr("write the number alone"));
  EXPECT_THAT(refuse("10:31:00.000 -> 1,2\n10:31:00.100 -> 1,2\n").hint, HasSubstr("replace \" -> \" by a comma"));
}

TEST(LoggerFiles, BlanksBetweenThousandsAreToldAsCommasAre) {
  const Error blanks = refuse("t (s);F (N);U (mV)\n0,000;0,4;0 598,79\n0,020;0,4;0 619,66\n0,040;0,4;1 032,15\n");
  EXPECT_EQ(blanks.where, "x.csv:2:11");
  EXPECT_EQ(blanks.hint, "write 598,79 and not 0 598,79: nothing may part the thousands");
  const Error later = refuse("t (s);F (N);U (mV)\n0,000;0,4;598,79\n0,020;0,4;1 019,66\n");
  EXPECT_EQ(later.where, "x.csv:3:11");
  EXPECT_EQ(later.hint, "write 1019,66 and not 1 019,66: nothing may part the thousands");
}

TEST(LoggerFiles, ACellThatIsMissingBetweenBlanksCannotBeLeftEmpty) {
  for (const char* text : {"t_s F_ref_N U_V\n0 1 2\n1 2\n", "t_s F_ref_N U_V\n0 1\n1 2 3\n"}) {
    const Error e = refuse(text);
    EXPECT_THAT(e.hint, HasSubstr("write nan for a missing value, or separate the columns by commas")) << text;
    EXPECT_THAT(e.hint, Not(HasSubstr("value empty"))) << text;
  }
  EXPECT_THAT(refuse("t_s,F_ref_N,U_V\n0,1,2\n1,2\n").hint, HasSubstr("leave a missing value empty"));
  EXPECT_EQ(read("t_s F_ref_N U_V\n0 1 2\n1 2 nan\n").trace.size(), 2u);
}

using FilesByContent = FolderTest;

TEST_F(FilesByContent, AFileIsKnownByHowItBegins) {
  const std::string text = "t_s,F_ref_N,U_V\n" + rows_of();
  for (const char* name : {"run", "run.log", "run.CSV"}) EXPECT_TRUE(read_trace(put(name, text))) << name;
  ASSERT_TRUE(convert_trace(put("run.csv", text), folder_ / "run.h5"));
  ASSERT_TRUE(convert_trace(folder_ / "run.csv", folder_ / "run.mat"));
  fs::rename(folder_ / "run.h5", folder_ / "five");
  fs::rename(folder_ / "run.mat", folder_ / "mat.data");
  for (const char* name : {"five", "mat.data"}) {
    const auto file = read_trace(folder_ / name);
    ASSERT_TRUE(file) << name << file.error().to_text();
    EXPECT_EQ(file->trace.size(), 40u) << name;
  }
  const auto workbook = read_trace(put("book.xls", "\xD0\xCF\x11\xE0 and so on"));
  ASSERT_FALSE(workbook);
  EXPECT_THAT(workbook.error().hint, HasSubstr("export the sheet"));
}

TEST_F(FilesByContent, AFolderHoldsEndingsInCapitalsAndTextWhereThereIsNothingElse) {
  const std::string text = "t_s,F_ref_N,U_V\n" + rows_of();
  put("a.txt", text);
  put("b.lvm", text);
  const auto texts = read_campaign(folder_);
  ASSERT_TRUE(texts) << texts.error().to_text();
  EXPECT_EQ(texts->records.size(), 2u);
  put("DATALOG.CSV", "t_s,F_ref_N,U_V\n0,1,2\n1,2,3\n");
  const auto logs = read_campaign(folder_);
  ASSERT_TRUE(logs);
  ASSERT_EQ(logs->records.size(), 1u) << "a text beside records is a note";
  EXPECT_EQ(logs->records.front().name, "DATALOG");
  fs::remove(folder_ / "DATALOG.CSV");
  put("a.txt", "only words");
  put("b.lvm", "and more\n");
  const auto words = read_campaign(folder_);
  ASSERT_FALSE(words);
  EXPECT_THAT(words.error().text, HasSubstr("holds no .csv"));
}

}  // namespace
}  // namespace forcegate
