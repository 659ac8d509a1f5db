// Names of columns and terms that `forcegate laws` is given.

#include "hil/app/diagnose/laws.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::HasSubstr;

class Laws : public FolderTest {
 protected:
  // b = 0.005 + 0.002 f, and a scatter that no column tells
  LawsRequest table() const {
    std::string text = "f_Hz,A_N,m_N,b\n";
    for (int i = 0; i < 18; ++i) {
      const double f_Hz = 0.5 + 0.1 * (i % 6), A_N = 1.0 + 0.3 * (i / 6), m_N = 2.0 + 0.1 * ((7 * i) % 5);
      text += std::to_string(f_Hz) + "," + std::to_string(A_N) + "," + std::to_string(m_N) + "," + std::to_string(0.005 + 0.002 * f_Hz + 1e-5 * ((5 * i) % 7)) + "\n";
    }
    LawsRequest request;
    request.table = put("table.csv", text);
    request.of = {"b"};
    return request;
  }
};

TEST_F(Laws, ATermMayBeCalledAsTheFileDoes) {
  for (const char* term : {"f", "f_Hz"}) {
    LawsRequest request = table();
    request.law = {term};
    const auto answers = laws(request);
    ASSERT_TRUE(answers) << term << ": " << answers.error().to_text();
    EXPECT_EQ(answers->front().law.back().term, "f") << term;
  }
}

TEST_F(Laws, ATermOfTheLawNeedsNoPlaceAmongTheCovariates) {
  LawsRequest request = table();
  request.law = {"f"};
  request.over = {"A", "m_N"};
  const auto answers = laws(request);
  ASSERT_TRUE(answers) << answers.error().to_text();
  EXPECT_TRUE(answers->front().added.empty());
}

TEST_F(Laws, NothingIsExplainedByItself) {
  LawsRequest over = table(), law = table();
  over.over = {"b", "f"};
  law.law = {"b"};
  for (const LawsRequest& request : {over, law}) {
    const auto answers = laws(request);
    ASSERT_FALSE(answers);
    EXPECT_THAT(answers.error().text, HasSubstr("nothing is explained by itself"));
  }
}

TEST_F(Laws, AParameterIsExplainedOnce) {
  LawsRequest request = table();
  request.of = {"b", "b"};
  const auto answers = laws(request);
  ASSERT_FALSE(answers);
  EXPECT_THAT(answers.error().to_text(), HasSubstr("the parameter 'b' is named twice"));
}

TEST_F(Laws, ACovariateThatIsNotThereIsNamed) {
  LawsRequest request = table();
  request.law = {"ln humidity"};
  const auto answers = laws(request);
  ASSERT_FALSE(answers);
  EXPECT_THAT(answers.error().to_text(), HasSubstr("no column 'humidity'"));
}

TEST_F(Laws, TheEquationIsOfWhatTheScaleMakesOfTheParameter) {
  for (const auto& [scale, response] : {std::pair{"linear", "b"}, std::pair{"log", "ln b"}, std::pair{"reciprocal", "1/b"}}) {
    LawsRequest request = table();
    request.scale = scale;
    request.law = {"f"};
    const auto answers = laws(request);
    ASSERT_TRUE(answers) << answers.error().to_text();
    EXPECT_THAT(laws_text(*answers), HasSubstr(std::string("law: ") + response + " = "));
    EXPECT_THAT(laws_text(*answers), HasSubstr(scale == std::string("linear") ? "leave-one-out error: " : std::string("leave-one-out error of ") + response + ": "));
  }
  LawsRequest falls = table();
  falls.scale = "reciprocal";
  falls.law = {"f"};
  EXPECT_THAT(laws_text(*laws(falls)), HasSubstr(" - ")) << "1/b falls with f";
}

TEST_F(Laws, ARowWithAGapIsLeftOutAndAColumnOfTextIsNoCovariateAndBothAreTold) {
  LawsRequest request = table();
  std::ifstream file(request.table);
  std::string text, line;
  for (int row = 0; std::getline(file, line); ++row) text += (row == 4 ? "," + line.substr(line.find(',') + 1) : line) + (row == 0 ? ",glue" : row % 2 == 0 ? ",soft" : ",hard") + "\n";
  request.table = put("with_gap.csv", text);
  std::vector<std::string> notes;
  const auto answers = laws(request, &notes);
  ASSERT_TRUE(answers) << answers.error().to_text();
  EXPECT_EQ(answers->front().n, 17U);
  EXPECT_THAT(notes, ::testing::Contains("a row with a gap is left out: line 5 (f)"));
  EXPECT_THAT(notes, ::testing::Contains(HasSubstr("the column 'glue' holds text ('hard') and is no covariate")));
  request.over = {"glue"};
  const auto words = laws(request);
  ASSERT_FALSE(words);
  EXPECT_THAT(words.error().text, HasSubstr("the column 'glue' holds text"));
}

TEST_F(Laws, AnUncertaintyOfNoneIsToldWithItsLine) {
  LawsRequest request = table();
  std::string text = "f_Hz,A_N,m_N,b,u_b\n";
  for (int i = 0; i < 18; ++i) text += std::to_string(0.5 + 0.1 * (i % 6)) + "," + std::to_string(1 + i / 6) + ",2,0.00" + std::to_string(5 + i % 4) + (i == 3 ? ",0\n" : ",0.0001\n");
  request.table = put("u.csv", text);
  const auto answers = laws(request);
  ASSERT_FALSE(answers);
  EXPECT_THAT(answers.error().where, ::testing::EndsWith("u.csv:5"));
  EXPECT_THAT(answers.error().text, HasSubstr("u_b = 0"));
}

TEST_F(Laws, ManyGapsAreNamedWithTheFirstOfThem) {
  LawsRequest request = table();
  std::ifstream file(request.table);
  std::string text, line;
  for (int row = 0; std::getline(file, line); ++row) text += (row > 8 ? "," + line.substr(line.find(',') + 1) : line) + "\n";
  request.table = put("with_gaps.csv", text);
  const auto answers = laws(request);
  ASSERT_FALSE(answers);
  EXPECT_THAT(answers.error().text, HasSubstr("10 of 18 rows have a gap: the first one in f"));
  EXPECT_THAT(answers.error().where, HasSubstr("with_gaps.csv:10"));
  request.over = {"A", "m"};
  EXPECT_TRUE(laws(request)) << "f is not asked for";
}

TEST_F(Laws, AParameterThatIsTheSameInEveryRecordIsConstant) {
  LawsRequest request = table();
  std::ifstream file(request.table);
  std::string text, line;
  for (int row = 0; std::getline(file, line); ++row) text += row == 0 ? line + "\n" : line.substr(0, line.rfind(',')) + ",0.005\n";
  request.table = put("constant.csv", text);
  const auto answers = laws(request);
  ASSERT_TRUE(answers) << answers.error().to_text();
  EXPECT_EQ(laws_text(*answers), "b is the same in every record, 0.005: there is nothing to explain\n");
}

TEST_F(Laws, WhatIsTheSameInEveryRecordMakesNoProduct) {
  LawsRequest request = table();
  std::ifstream file(request.table);
  std::string text, line;
  for (bool head = true; std::getline(file, line); head = false) text += line + (head ? ",bench\n" : ",5\n");
  request.table = put("with_constant.csv", text);
  const auto answers = laws(request);
  ASSERT_TRUE(answers) << answers.error().to_text();
  for (const RankedTerm& r : answers->front().ranking) EXPECT_NE(r.term.other, "bench") << to_string(r.term);
}

}  // namespace
}  // namespace forcegate
