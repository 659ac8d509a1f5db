// Tables that hold several sensors or trials: refused with the way to split them, and split.

#include "hil/trace/part_column.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hil/trace/csv.h"

namespace forcegate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// `rows` rows of clock, `header` and a force and output that move; cell(i) stands in the second column, the clock is clock(i).
template <class Cell, class Stamp>
std::string table(std::string_view header, int rows, Cell cell, Stamp clock) {
  std::string text = "t_s," + std::string(header) + ",F_ref_N,U_V\n";
  for (int i = 0; i < rows; ++i) text += std::to_string(clock(i)) + "," + cell(i) + "," + std::to_string(std::sin(0.1 * i)) + "," + std::to_string(0.2 * std::sin(0.1 * i)) + "\n";
  return text;
}

double every_10_ms(int i) { return 0.01 * i; }

Error error_of(const std::string& text, const CsvOptions& options = {}) {
  const auto file = parse_csv(text, "x.csv", options);
  EXPECT_FALSE(file);
  return file ? Error{} : file.error();
}

TEST(PartColumn, SensorsThatTakeTurnsAreNoRecording) {
  const std::string text = table("Sensor ID", 100, [](int i) { return std::to_string(i % 3); }, every_10_ms);
  const Error error = error_of(text);
  EXPECT_THAT(error.text, HasSubstr("column \"Sensor ID\" is 0, 1, 2, 0, ... in turn"));
  EXPECT_THAT(error.hint, HasSubstr("forcegate convert x.csv FOLDER --split 'Sensor ID'"));
  EXPECT_TRUE(parse_csv(text, "x.csv", {{{"Sensor ID", "unused"}}, 0.0}));
}

TEST(PartColumn, SoAreSensorsWithNames) {
  EXPECT_THAT(error_of(table("place", 100, [](int i) { return std::string(i % 2 == 0 ? "heel" : "toe"); }, every_10_ms)).text, HasSubstr("heel, toe, heel, toe"));
}

TEST(PartColumn, AFlagOrARemarkIsNoSensor) {
  EXPECT_TRUE(parse_csv(table("heater", 100, [](int i) { return std::to_string(i % 2); }, every_10_ms), "x.csv"));
  EXPECT_TRUE(parse_csv(table("channel", 100, [](int i) { return std::to_string(i / 50); }, every_10_ms), "x.csv"));
  EXPECT_TRUE(parse_csv(table("direction", 100, [](int i) { return std::string(i / 10 % 2 == 0 ? "up" : "down"); }, every_10_ms), "x.csv"));
}

TEST(PartColumn, WhereTheClockJumpsBackTheColumnThatChangesThereIsTold) {
  const auto restarts = [](int i) { return 0.01 * (i % 50); };
  EXPECT_THAT(error_of(table("trial", 150, [](int i) { return std::to_string(i / 50); }, restarts)).hint, HasSubstr("convert x.csv FOLDER --split trial"));
  EXPECT_THAT(error_of(table("trial", 150, [](int i) { return std::string(i / 50 == 0 ? "first" : "second"); }, restarts)).hint, HasSubstr("--split trial"));
  EXPECT_THAT(error_of(table("trial", 150, [](int) { return std::string("1"); }, restarts)).hint, HasSubstr("split the file where a new recording begins"));
}

TEST(PartColumn, RowsOfAPartKeepTheirLines) {
  const auto whole = parse_csv_table("# of a lab\nt_s,trial,F_ref_N,note\n0,a,1,x\n\n0,b,2,x\n1,a,3,y\n1,b,,y\n", "x.csv");
  ASSERT_TRUE(whole);
  const auto column = part_column(*whole, "trial", "x.csv");
  ASSERT_TRUE(column) << column.error().to_text();
  EXPECT_THAT(column->parts, ElementsAre("a", "b"));
  const CsvTable b = rows_of_part(*whole, *column, 1);
  ASSERT_EQ(b.columns.size(), 2u);
  EXPECT_THAT(b.columns[0].value, ElementsAre(0.0, 1.0));
  EXPECT_EQ(b.columns[1].value[0], 2.0);
  EXPECT_EQ(b.columns[1].missing, 1u);
  EXPECT_EQ(b.line_of_row(0), 5u);
  EXPECT_EQ(b.line_of_row(1), 7u);
  ASSERT_EQ(b.text_columns.size(), 1u);
  EXPECT_THAT(b.text_columns[0].word_of_row, ElementsAre(0, 1));
}

TEST(PartColumn, WhatTellsNoPartsIsRefused) {
  const auto whole = parse_csv_table("t_s,trial,one,gap,F_ref_N\n0,1.5,1,a,1\n1,2,1,,2\n2,2,1,b,3\n", "x.csv");
  ASSERT_TRUE(whole);
  const auto hint = [&](const char* header) { return part_column(*whole, header, "x.csv").error().to_text(); };
  EXPECT_THAT(hint("trail"), HasSubstr("the columns are t_s, trial, one, F_ref_N, gap"));
  EXPECT_THAT(hint("trial"), HasSubstr("does not tell parts"));
  EXPECT_THAT(hint("gap"), HasSubstr("does not tell parts"));
  EXPECT_THAT(hint("one"), HasSubstr("is 1 in every row"));
}

TEST(PartColumn, MoreWordsThanPartsAreARemark) {
  const auto whole = parse_csv_table(table("remark", 100, [](int i) { return "n" + std::to_string(i); }, every_10_ms), "x.csv");
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->text_columns.at(0).words.empty());
  EXPECT_TRUE(whole->text_columns.at(0).word_of_row.empty());
  EXPECT_FALSE(part_column(*whole, "remark", "x.csv"));
}

TEST(PartColumn, ALastLineThatWasDroppedHasNoWord) {
  const auto whole = parse_csv_table("t_s,place,F_ref_N,U_V\n0,a,1,1\n1,b,2,2\n2,a,3", "x.csv");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->rows(), 2u);
  EXPECT_THAT(whole->text_columns.at(0).word_of_row, ElementsAre(0, 1));
}

TEST(PartColumn, AColumnThatIsCalledByAUnitOfTimeIsTheClock) {
  const auto file = parse_csv("ms,force_N,adc\n0,0.1,3\n10,0.2,4\n20,0.3,5\n30,0.2,4\n", "x.csv");
  ASSERT_TRUE(file) << file.error().to_text();
  EXPECT_THAT(file->trace.time_bases.at(0).t_s, ElementsAre(0.0, 0.01, 0.02, 0.03));
  EXPECT_THAT(file->notes, ::testing::Contains(HasSubstr("\"ms\" was taken for the clock")));
}

}  // namespace
}  // namespace forcegate
