#include "hil/trace/csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/trace/decimal.h"
#include "hil/trace/missing_count.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Error refuse(std::string_view text, const CsvOptions& options = {}) {
  const auto file = parse_csv(text, "x.csv", options);
  EXPECT_FALSE(file);
  return file ? Error{} : file.error();
}

TEST(ReadCsv, TakesNamesAndUnitsFromTheHeader) {
  const auto f = read("t_s,F_ref_N,U_V,temp_C,C_F\n0,1,2,20,1e-9\n0.1,1.5,2.5,21,2e-9\n");
  ASSERT_EQ(f.trace.channels.size(), 4u);
  EXPECT_TRUE(f.notes.empty());
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1, 1.5}));
  EXPECT_EQ(f.trace.find("U")->unit, "V");
  EXPECT_EQ(f.trace.find("C")->quantity, "capacitance");
  EXPECT_EQ(f.trace.time_bases[0].t_s, (std::vector<double>{0, 0.1}));
}

TEST(ReadCsv, TakesASumBelowTheRowsForNoMissingValue) {
  const Error total = refuse("t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,2.5\nTotal,6000,samples\n");
  EXPECT_EQ(total.where, "x.csv:4:1");
  EXPECT_THAT(total.hint, HasSubstr("take the line out"));
  EXPECT_THAT(refuse("t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,2.5\n0.2,OL,OL\n").hint, HasSubstr("leave the cell empty"));
}

TEST(ReadCsv, TellsATypographicMinusInTheClockToo) {
  EXPECT_THAT(refuse("t_s,F_ref_N\n\u22120.1,1\n\u22120.0,2\n").hint, HasSubstr("U+2212"));
}

TEST(ReadCsv, ConvertsUnitsAndSaysSo) {
  const auto f = read("t_ms,F_ref_mN,theta_deg,temp_degF\n0,1500,180,212\n1,1600,90,32\n");
  EXPECT_DOUBLE_EQ(f.trace.find("F_ref")->value[0], 1.5);
  EXPECT_NEAR(f.trace.find("theta")->value[0], 3.14159265358979, 1e-12);
  EXPECT_NEAR(f.trace.find("temp")->value[0], 100.0, 1e-9);
  EXPECT_DOUBLE_EQ(f.trace.time_bases[0].t_s[1], 1e-3);
  EXPECT_THAT(f.notes, Contains(HasSubstr("\"F_ref_mN\" was converted from mN to N")));
}

TEST(ReadCsv, AcceptsMarksCarriageReturnsCommentsBlankLinesAndQuotes) {
  const auto f = read(
      "\xEF\xBB\xBF# bench 3\r\n\r\n\"t_s\" , \"F_ref_N\"\r\n0,1\r\n# pause\r\n\r\n0.5,\"2\"\r\n 1.0 , 3 \r\n");
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1, 2, 3}));
}

TEST(ReadCsv, UnderstandsSemicolonsWithDecimalCommasTabsAndBlanks) {
  const auto f = read("t_s;F_ref_N\n0,5;-1,25\n0,6;1,5e1\n0,7;2\n");
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{-1.25, 15, 2}));
  EXPECT_THAT(f.notes, Contains("the decimals are commas"));
  EXPECT_EQ(read("t_s\tF_ref_N\n0\t1\n1\t2\n").trace.find("F_ref")->value[1], 2.0);
  EXPECT_EQ(read("t_s  F_ref_N\n 0    1\n 1   2\n").trace.find("F_ref")->value[1], 2.0);
}

TEST(Csv, CommasBeforeUnitsPartNoCellsBesideAnotherSeparator) {
  for (const std::string separator : {"\t", ";"}) {
    const std::string text = "Time,s" + separator + "F_ref, mN" + separator + "U,V\n0" + separator + "1000" + separator + "3\n1" + separator + "2000" + separator + "4\n";
    const auto got = read(text);
    ASSERT_NE(got.trace.find("F_ref"), nullptr) << text;
    EXPECT_DOUBLE_EQ(got.trace.find("F_ref")->value[1], 2.0);
    EXPECT_DOUBLE_EQ(got.trace.find("U")->value[0], 3.0);
  }
  EXPECT_EQ(read("t_s,F_ref_N,note; of the cell\n0,1,2\n1,2,3\n").trace.find("F_ref")->value[1], 2.0);
}

TEST(ReadCsv, MissingCellsAreNotANumber) {
  const auto f = read("t_s,F_ref_N,U_V\n0,,1\n1,nan,2\n2,NA,3\n3,4,\n4,inf,6\n");
  const auto& force = f.trace.find("F_ref")->value;
  EXPECT_TRUE(std::isnan(force[0]) && std::isnan(force[1]) && std::isnan(force[2]) && std::isnan(force[4]));
  EXPECT_EQ(force[3], 4.0);
  EXPECT_THAT(f.notes, Contains(HasSubstr("misses 4 of 5")));
}

TEST(ReadCsv, AnInstrumentsOverloadIsAMissingValue) {
  const auto f = read("t_s,F_ref_N,U_V\n0,1,2\n0.1,1.5,9.91E37\n0.2,-9.9E+37,2.5\n0.3,1,1e300\n");
  EXPECT_TRUE(std::isnan(f.trace.find("U")->value[1]));
  EXPECT_TRUE(std::isnan(f.trace.find("U")->value[3]));
  EXPECT_TRUE(std::isnan(f.trace.find("F_ref")->value[2]));
  EXPECT_EQ(f.trace.find("U")->value[2], 2.5);
  EXPECT_THAT(f.notes, Contains(HasSubstr("\"U_V\": 2 values of 9.9e37 and more are an instrument's overload")));
  EXPECT_THAT(f.notes, Contains(HasSubstr("misses 2 of 4 samples")));
}

TEST(ReadCsv, NamesLineAndColumnOfABadCell) {
  const auto e = refuse("t_s,F_ref_N\n0,1\n1,2\n2,x7\n");
  EXPECT_EQ(e.where, "x.csv:4:3");
  EXPECT_THAT(e.text, HasSubstr("\"x7\""));
  EXPECT_EQ(e.code, ErrorCode::parse);
}

TEST(ReadCsv, NamesTheLineOfARaggedRowAndSuspectsDecimalCommas) {
  EXPECT_EQ(refuse("t_s,F_ref_N,U_V\n0,1,2\n1,2\n2,3,4\n").where, "x.csv:3:4");
  EXPECT_THAT(refuse("t_s,F_ref_N\n0,0,1,5\n0,1,1,6\n").hint, HasSubstr("decimal commas"));
}

TEST(ReadCsv, DropsALastLineThatWasCutShort) {
  const auto f = read("t_s,F_ref_N\n0,1\n1,2\n2");
  EXPECT_EQ(f.trace.size(), 2u);
  EXPECT_THAT(f.notes, Contains(HasSubstr("cut short")));
}

TEST(ReadCsv, RefusesWhatIsNoTable) {
  EXPECT_THAT(refuse("").text, HasSubstr("empty"));
  EXPECT_THAT(refuse("t_s,F_ref_N\n").text, HasSubstr("no rows"));
  EXPECT_THAT(refuse("0,1,2\n1,2,3\n").text, HasSubstr("numbers, not column names"));
  EXPECT_THAT(refuse("\x89HDF\r\n\x1a\n").hint, HasSubstr(".h5"));
  EXPECT_THAT(refuse(std::string("a\0b,c\n1,2\n", 10)).text, HasSubstr("binary"));
}

TEST(ReadCsv, ReadsASecondLineOfUnits) {
  const auto f = read("t,F_ref,U\ns,mN,[V]\n0,1000,1\n1,2000,2\n");
  EXPECT_DOUBLE_EQ(f.trace.find("F_ref")->value[1], 2.0);
}

TEST(ReadCsv, LeavesColumnsOfTextOut) {
  const auto f = read("t_s,F_ref_N,remark\n0,1,start\n1,2,\n2,3,end\n");
  EXPECT_EQ(f.trace.channels.size(), 1u);
  EXPECT_THAT(f.notes, Contains(HasSubstr("\"remark\" holds text")));
}

TEST(ReadCsv, RecognisesForeignNamesWhereThatIsUnambiguous) {
  const auto f = read("time_s,position_mm,pressure_bar,force_N\n0,1,2,3\n1,2,3,4\n");
  EXPECT_EQ(f.trace.find("F_ref")->value[1], 4.0);
  EXPECT_THAT(f.notes, Contains("column \"force_N\" was taken for F_ref"));
  EXPECT_EQ(f.trace.find("position")->unit, "m");
  EXPECT_EQ(f.trace.find("pressure")->unit, "Pa");
  const auto two = read("time_s,pump_V,level_V\n0,1,2\n1,2,3\n");
  EXPECT_EQ(two.trace.find("U"), nullptr);
  EXPECT_NE(two.trace.find("level"), nullptr);
  const auto one = read("Time (s),Pressure cell [V]\n0,1\n1,2\n");
  EXPECT_EQ(one.trace.find("U")->value[1], 2.0);
  const auto bare = read("t,F,U,T,theta\n0,1,2,3,4\n1,2,3,4,5\n");
  EXPECT_EQ(bare.trace.find("temp")->value[0], 3.0);
  EXPECT_EQ(bare.trace.find("F_ref")->unit, "N");
}

TEST(ReadCsv, FollowsTheColumnMap) {
  const auto f =
      read("stamp,a,b\n0,1,2\n1,3,4\n", {.column_map = {{"stamp", "t_s"}, {"a", "F_ref_mN"}, {"b", "U_V"}}});
  EXPECT_DOUBLE_EQ(f.trace.find("F_ref")->value[1], 3e-3);
  EXPECT_EQ(f.trace.find("U")->value[1], 4.0);
}

TEST(Csv, AColumnThatIsCalledByItsUnitIsInThatUnitWhateverItIsMappedTo) {
  const auto f = read("t_s,kgf,U_V\n0,1,2\n1,3,4\n", {.column_map = {{"kgf", "F_ref_N"}}});
  ASSERT_EQ(f.trace.channels.front().name, "F_ref");
  EXPECT_NEAR(f.trace.channels.front().value[1], 3.0 * 9.80665, 1e-9);
  EXPECT_THAT(f.notes, Contains("column \"kgf\" was read in kgf, as it is called"));
}

TEST(Csv, AMapToAnotherUnitThanAColumnIsCalledByIsTold) {
  const auto f = read("t_s,kgf,U_V\n0,1,2\n1,3,4\n", {.column_map = {{"kgf", "F_ref_lbf"}}});
  EXPECT_NEAR(f.trace.channels.front().value[1], 3.0 * 4.4482216152605, 1e-9);
  EXPECT_THAT(f.notes, Contains("column \"kgf\" was read in lbf, though it is called kgf"));
}

TEST(ReadCsv, AMappedColumnKeepsTheUnitOfItsHeader) {
  const auto f = read("Time_ms,Cell_bar,Sensor_mV\n0,1,2\n1000,3,4\n",
                      {.column_map = {{"Time_ms", "t_s"}, {"Cell_bar", "F_ref_N"}, {"Sensor_mV", "U_V"}}});
  EXPECT_DOUBLE_EQ(f.trace.time_bases[0].t_s[1], 1.0);
  EXPECT_DOUBLE_EQ(f.trace.find("F_ref")->value[1], 3.0) << "a pressure is no force: the name gives the unit";
  EXPECT_DOUBLE_EQ(f.trace.find("U")->value[1], 4e-3);
  EXPECT_THAT(f.notes, testing::Contains(HasSubstr("converted from mV to V")));
  const auto g = read("t_s,F_ref_N,Sensor_mV\n0,1,2\n1,3,4\n", {.column_map = {{"Sensor_mV", "U_uV"}}});
  EXPECT_DOUBLE_EQ(g.trace.find("U")->value[1], 4e-6) << "a unit that is not SI is meant";
}

TEST(ReadCsv, AVelocityIsNoClock) {
  const auto e = refuse("sample,velocity_cm_s,force_N\n0,1,2\n1,2,3\n");
  EXPECT_THAT(e.text, HasSubstr("no time column"));
  const auto f =
      read("sample,velocity_cm_s,force_N\n0,1,2\n1,2,3\n", {.column_map = {}, .assumed_rate_Hz = 200});
  EXPECT_TRUE(f.trace.time_bases[0].invented);
  EXPECT_DOUBLE_EQ(f.trace.time_bases[0].t_s[1], 0.005);
  EXPECT_EQ(f.trace.find("velocity")->unit, "cm/s");
}

TEST(ReadCsv, KeepsCountsBesideTheVoltage) {
  const auto f = read("t_s,U_V,U_counts,adc_counts\n0,1,6553,7\n1,,,8\n");
  ASSERT_EQ(f.trace.channels.size(), 2u);
  EXPECT_EQ(f.trace.find("U")->raw, (std::vector<std::int32_t>{6553, kMissingCount}));
  EXPECT_EQ(f.trace.find("adc")->raw, (std::vector<std::int32_t>{7, 8}));
}

TEST(ReadCsv, ListsGapsOfAnIrregularClock) {
  std::string text = "t_s,F_ref_N\n";
  double t = 0.0;
  for (int i = 0; i < 500; ++i) {
    text += shortest(t) + ",1\n";
    t += i == 100 ? 0.29 : i % 9 == 0 ? 0.012 : 0.01;
  }
  const auto f = read(text);
  ASSERT_EQ(f.trace.time_bases[0].gaps.size(), 1u);
  EXPECT_EQ(f.trace.time_bases[0].gaps[0].index, 101u);
  EXPECT_NEAR(f.trace.time_bases[0].nominal_rate_Hz, 97.8, 0.5);
  EXPECT_THAT(f.notes, Contains("1 gap in the clock, the longest 0.29 s"));
}

TEST(ReadCsv, ToleratesStampsRoundedToMilliseconds) {
  std::string text = "t_s,F_ref_N\n";
  for (int i = 0; i < 1000; ++i) text += shortest(std::floor(i * 2.5) / 1000.0) + ",1\n";
  const auto f = read(text);
  EXPECT_TRUE(f.trace.time_bases[0].gaps.empty());
  EXPECT_NEAR(f.trace.time_bases[0].nominal_rate_Hz, 400.0, 0.5);
}

TEST(ReadCsv, SortsRowsThatCameLateAndRefusesAClockThatRestarts) {
  const auto f = read("t_s,F_ref_N\n0,1\n2,3\n1,2\n3,4\n3,5\n,6\n");
  EXPECT_EQ(f.trace.find("F_ref")->value, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_THAT(f.notes, Contains(HasSubstr("out of order")));
  EXPECT_THAT(f.notes, Contains("1 row has no time stamp (line 7); dropped"));
  std::string twice = "t_s,F_ref_N\n";
  for (int run = 0; run < 2; ++run)
    for (int i = 0; i < 100; ++i) twice += std::to_string(i) + ",1\n";
  EXPECT_THAT(refuse(twice).text, HasSubstr("jumps back from 99 s to 0 s in line 102"));
}

TEST(ReadCsv, SaysOfAFileThatBeginsWithItsEndThatItRunsBackwards) {
  std::string rows = "t_s,F_ref_N\n";
  for (int i = 100; i > 0; --i) rows += std::to_string(i) + ",1\n";
  const Error e = refuse(rows);
  EXPECT_THAT(e.text, HasSubstr("the clock runs backwards, from 100 s down to 1 s"));
  EXPECT_THAT(e.hint, HasSubstr("sort the rows"));
}

TEST(Csv, AMapToAnotherQuantityIsTold) {
  const auto f = read("t_s,position_mm,force_N\n0,1,2\n1,3,4\n", {.column_map = {{"position_mm", "U_V"}}});
  EXPECT_THAT(f.notes, Contains("column \"position_mm\" is in mm and was read as V, as --map says: wherever V stands, mm is meant"));
  const auto same = read("t_s,Sensor_mV,force_N\n0,1,2\n1,3,4\n", {.column_map = {{"Sensor_mV", "U_V"}, {"force_N", "unused"}}});
  EXPECT_THAT(same.notes, Not(Contains(HasSubstr("is meant"))));
}

TEST(ReadCsv, NamesTheLinesOfRowsWithoutAStampAndCallsThemNoGaps) {
  std::string text = "# a bench\nt_s,F_ref_N\n";
  for (int i = 0; i < 200; ++i) {
    if (i == 150) i += 30;  // this is one
    text += (i % 20 == 7 ? "" : shortest(0.01 * i)) + ",1\n";
  }
  const auto f = read(text);
  EXPECT_THAT(f.notes, Contains("9 rows have no time stamp (lines 10, 30, 50 and 6 more); dropped"));
  EXPECT_THAT(f.notes, Contains("1 gap in the clock, the longest 0.31 s"));
  EXPECT_EQ(f.trace.time_bases[0].gaps.size(), 10u);
}

TEST(ReadCsv, ReadsAFileLikeTheSameTextFromMemory) {
  Rng rng(4, "csv");
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 60000; ++i)
    text += shortest(i * 1e-3) + "," + shortest(rng.normal()) + "," +
            (i % 97 == 0 ? "" : shortest(rng.uniform())) + "\n";
  const std::string path = ::testing::TempDir() + "forcegate_csv_test.csv";
  std::ofstream(path, std::ios::binary) << text;
  const auto file = read_csv(path);
  ASSERT_TRUE(file);
  const auto memory = read(text);
  EXPECT_EQ(file->trace.find("F_ref")->value, memory.trace.find("F_ref")->value);
  EXPECT_EQ(file->trace.find("U")->value.size(), 60000u);
  std::remove(path.c_str());
  EXPECT_EQ(read_csv(path).error().code, ErrorCode::io);
}

TEST(WriteCsv, ReadsBackTheSameNumbers) {
  Rng rng(9, "csv");
  Trace trace;
  trace.time_bases.push_back({});
  trace.channels.resize(2);
  trace.channels[0] = {"F_ref", "N", "force", 0, {}, {}};
  trace.channels[1] = {"U", "V", "voltage", 0, {}, {}};
  for (int i = 0; i < 5000; ++i) {
    trace.time_bases[0].t_s.push_back(i * 1e-3);
    trace.channels[0].value.push_back(i % 50 == 0 ? kMissing
                                                  : rng.normal() * std::pow(10.0, rng.uniform(-20, 20)));
    trace.channels[1].value.push_back(i * 1e-4);
    trace.channels[1].raw.push_back(i);
  }
  const std::string path = ::testing::TempDir() + "forcegate_csv_round.csv";
  ASSERT_TRUE(write_csv(trace, path));
  const auto back = read_csv(path);
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->trace.time_bases[0].t_s, trace.time_bases[0].t_s);
  EXPECT_EQ(back->trace.find("U")->value, trace.channels[1].value);
  EXPECT_EQ(back->trace.find("U")->raw, trace.channels[1].raw);
  for (std::size_t i = 0; i < 5000; ++i) {
    const double a = back->trace.find("F_ref")->value[i], b = trace.channels[0].value[i];
    EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
  }
  std::remove(path.c_str());
}

TEST(ReadPlainDecimal, AgreesWithTheStandardLibraryToTheLastBit) {
  Rng rng(2, "decimal");
  for (int i = 0; i < 200000; ++i) {
    char text[64];
    const int decimals = static_cast<int>(rng.below(12));
    std::snprintf(text, sizeof text, "%.*f\n", decimals, rng.normal() * std::pow(10.0, rng.uniform(-6, 6)));
    double ours = 0.0, theirs = 0.0;
    const char* end = read_plain_decimal(text, '.', ours);
    if (!end) continue;
    std::from_chars(text, text + sizeof text, theirs);
    ASSERT_EQ(std::memcmp(&ours, &theirs, sizeof ours), 0) << text;
    ASSERT_EQ(*end, '\n');
  }
}

TEST(ReadCsv, AForceOrAClockOfTextIsAnErrorAndAnyOtherIsLeftOut) {
  const auto force = refuse("t,F,U\n0,\"1,234.5\",1\n1,\"1,235.5\",2\n");
  EXPECT_THAT(force.text, HasSubstr("\"F\""));
  EXPECT_EQ(force.where, "x.csv:2:3");
  EXPECT_THAT(force.hint, HasSubstr("1234.5"));
  EXPECT_THAT(refuse("t,F,U\n01/02/2026 10:00:00,1,1\n01/02/2026 10:00:01,1,1\n").hint, HasSubstr("2024-05-31T10:31:07"));
  EXPECT_THAT(read("t,F,U,who\n0,1,1,me\n1,2,2,me\n").notes, Contains(HasSubstr("\"who\" holds text")));
}

TEST(ReadCsv, TwoColumnsOfOneNameAreRefused) {
  const auto e = refuse("t,F,F,U\n0,1,2,3\n1,1,2,3\n");
  EXPECT_THAT(e.text, HasSubstr("two columns are called \"F\""));
  EXPECT_EQ(e.where, "x.csv:1:1");
}

TEST(ReadCsv, KnowsBothSignsForMicro) {
  EXPECT_DOUBLE_EQ(read("t,F [N],U [\xC2\xB5V]\n0,1,2000\n1,2,2000\n").trace.find("U")->value[0], 0.002);
  EXPECT_DOUBLE_EQ(read("t,F [N],U [\xCE\xBCV]\n0,1,2000\n1,2,2000\n").trace.find("U")->value[0], 0.002);
}

}  // namespace
}  // namespace forcegate
