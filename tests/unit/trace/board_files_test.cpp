// What boards print and people write by hand: cells with their labels, counters of 16 bits, durations, units behind "in".

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/base/units.h"
#include "hil/trace/column_map.h"
#include "hil/trace/csv.h"
#include "hil/trace/date_time.h"
#include "tests/unit/trace/read_csv.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::string refusal(std::string_view text, const CsvOptions& options = {}) {
  const auto file = parse_csv(text, "x.txt", options);
  EXPECT_FALSE(file);
  return file ? "" : file.error().to_text();
}

TEST(BoardFiles, CellsThatTellTheirLabelAreReadUnderIt) {
  for (const char* text : {"ms:0\tForce:29.5\tADC:38\nms:10\tForce:30.5\tADC:39\nms:20\tForce:31.5\tADC:40\n",
                           "ms: 0, Force: 29.5, ADC: 38\r\nms: 10, Force: 30.5, ADC: 39\r\nms: 20, Force: 31.5, ADC: 40\r\n",
                           "ms:0 Force:29.5 ADC:38\nms:10 Force:30.5 ADC:39\nms:20 Force:31.5 ADC:40\n"}) {
    const auto f = read(text);
    ASSERT_NE(f.trace.find("F_ref"), nullptr) << text;
    EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(29.5, 30.5, 31.5));
    EXPECT_THAT(f.trace.find("U")->value, ElementsAre(38, 39, 40));
    EXPECT_NEAR(f.trace.time_bases[0].t_s[1], 0.01, 1e-12);
    EXPECT_THAT(f.notes, Contains(HasSubstr("from the labels before the numbers")));
  }
}

TEST(BoardFiles, LinesAboveTheLabelsAndALastOneThatIsCutAreLeftOut) {
  const auto f = read("Sketch ready\n5\tADC:37\nms:0\tForce:29.5\tADC:38\nms:10\tForce:nan\tADC:39\nms:20\tForce:31.5\tADC:40\nms:30\tFor");
  EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(29.5, testing::IsNan(), 31.5));
  EXPECT_THAT(f.notes, Contains(HasSubstr("the 2 lines above them were skipped")));
  EXPECT_THAT(f.notes, Contains(HasSubstr("cut short")));
}

TEST(BoardFiles, ALabelThatChangesIsAnErrorInItsLine) {
  EXPECT_THAT(refusal("ms:0\tForce:29.5\nms:10\tForce:30.5\nms:20\tADC:38\n"), HasSubstr("x.txt:3:7"));
  CsvOptions options;
  options.assumed_rate_Hz = 50.0;
  EXPECT_THAT(read("time,F_ref_N\n10:31:00,1\n10:31:01,2\n").notes, Not(Contains(HasSubstr("labels")))) << "times of day are no labels";
  EXPECT_EQ(read("Force:1\tADC:2\nForce:2\tADC:3\nForce:3\tADC:4\n", options).trace.time_bases[0].nominal_rate_Hz, 50.0);
}

TEST(BoardFiles, ACounterOf16BitsGoesOn) {
  const auto f = read("t_ms,Force_N,adc\n65505,1,2\n65515,2,3\n65525,3,4\n65535,3,4\n9,4,5\n19,5,6\n");
  EXPECT_NEAR(f.trace.time_bases[0].t_s[5] - f.trace.time_bases[0].t_s[0], 0.05, 1e-9);
  EXPECT_THAT(f.notes, Contains(HasSubstr("passes 2^16, where a counter of 16 bits begins anew")));
  EXPECT_THAT(refusal("t_ms,Force_N,adc\n65400,1,2\n65410,2,3\n65420,3,4\n65430,3,4\n0,4,5\n10,5,6\n"), HasSubstr("jumps back")) << "a board that began anew";
}

TEST(BoardFiles, DurationsOfMatlabAreSeconds) {
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("0.01 sec"), 0.01);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("1.5 min"), 90.0);
  EXPECT_DOUBLE_EQ(*seconds_of_stamp("2 hr"), 7200.0);
  for (const char* none : {"0.01 s", "sec", " sec", "1.5.2 sec", "one min"}) EXPECT_FALSE(seconds_of_stamp(none)) << none;
  const auto f = read("Time,F_ref_N,U_V\n0 sec,1,2\n0.01 sec,2,3\n0.02 sec,3,4\n");
  EXPECT_THAT(f.trace.time_bases[0].t_s, ElementsAre(0.0, 0.01, 0.02));
}

TEST(BoardFiles, AUnitMayStandBehindTheWordIn) {
  const auto f = read("Zeit in ms;Kraft in mN;Spannung in V\n0;1500;1\n10;1600;2\n20;1700;3\n");
  EXPECT_THAT(f.trace.find("F_ref")->value, ElementsAre(1.5, 1.6, 1.7));
  EXPECT_NEAR(f.trace.time_bases[0].t_s[2], 0.02, 1e-12);
  EXPECT_NE(f.trace.find("U"), nullptr);
}

TEST(BoardFiles, PoundsForceAreKnownInAnyCase) {
  for (const char* symbol : {"lbf", "lbF", "LBF"}) EXPECT_EQ(find_unit(symbol)->symbol, "lbf") << symbol;
  EXPECT_EQ(find_unit("ozF")->symbol, "ozf");
  EXPECT_EQ(find_unit("kgF")->symbol, "kgf");
  EXPECT_NEAR(16.0 * find_unit("ozf")->factor, find_unit("lbf")->factor, 1e-12);
  EXPECT_NEAR(read("t_s,Load [lbF],U_V\n0,1,2\n1,2,3\n2,3,4\n").trace.find("F_ref")->value[1], 8.8964432305, 1e-9);
}

TEST(BoardFiles, AnAnalogPinHoldsCodes) {
  EXPECT_THAT(column_map_advice(read("t_s,F_ref_N,A0\n0,1,512\n1,2,600\n2,3,700\n").trace, "U", "V"), HasSubstr("--map A0=U_counts where it holds codes"));
  EXPECT_THAT(column_map_advice(read("t_s,F_ref_N,A0\n0,1,0.5\n1,2,0.6\n2,3,0.7\n").trace, "U", "V"), HasSubstr("\"A0\" is the only column left"));
  const std::string page(7000, 'x');
  EXPECT_THAT(column_map_advice(read("t_s,F_ref_N," + page + "\n0,1,0.5\n1,2,0.6\n2,3,0.7\n").trace, "U", "V"), HasSubstr("\"" + page.substr(0, 80) + "...\" is the only column left"));
}

}  // namespace
}  // namespace forcegate
