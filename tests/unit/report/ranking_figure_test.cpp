// What pictures and page of a diagnosis say of claims and of two errors, and how long a name may be in them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/report/diagnosis_figures.h"
#include "hil/report/diagnosis_html.h"
#include "hil/report/diagnosis_parts.h"
#include "hil/report/figures/plots.h"
#include "tests/support/sample_diagnosis.h"

namespace forcegate {
namespace {

using testing::HasSubstr;

TEST(RankingFigure, WithoutAClaimNamesNoFirst) {
  Diagnosis d = sample::diagnosis();
  EXPECT_THAT(ranking_figure(d).summary, HasSubstr("First: "));
  for (RankedEffect& r : d.ranking) r.probability = 0.0;
  EXPECT_THAT(ranking_figure(d).summary, HasSubstr("Nothing is right of the dotted line"));
}

TEST(RankingFigure, WithoutAShareOfTheResidualHasNoPanelOfShares) {
  Diagnosis d = sample::diagnosis();
  const auto svg = [&] { return ranking_figure(d).svg(figures::Figure::Target::embedded); };
  EXPECT_THAT(svg(), HasSubstr("Share of the explainable residual"));
  for (RankedEffect& r : d.ranking) r.alone = r.unique = 0.0;
  EXPECT_THAT(svg(), testing::AllOf(HasSubstr("Probability"), testing::Not(HasSubstr("Share of the explainable residual"))));
  EXPECT_THAT(ranking_figure(d).summary, testing::Not(HasSubstr("ring and dot")));
}

TEST(WaterfallFigure, WritesTheLongestNameOfAnEffectOut) {
  const figures::Figure figure = figures::waterfall("Error", "start", {{"static_nonlinearity", 1.0, 0.5}}, "now", "V", 0.1);
  EXPECT_THAT(figure.svg(figures::Figure::Target::embedded), HasSubstr("static_nonlinearity"));
}

TEST(PageOfADiagnosis, ComparesErrorsInOneUnit) {
  using parts::in_one_unit;
  EXPECT_EQ(in_one_unit(0.222, 0.126, "V"), std::pair(std::string("222 mV"), std::string("126 mV")));
  EXPECT_EQ(in_one_unit(1.5, 0.126, "V"), std::pair(std::string("1500 mV"), std::string("126 mV")));
  EXPECT_EQ(in_one_unit(1.5, 0.00002, "V").first, "1.5 V") << "three digits of microvolts are no size of volts";
  EXPECT_EQ(in_one_unit(0.05, 0.0, "V").first, "50 mV");
}

TEST(PageOfADiagnosis, SaysOfWhichStructureItSpeaks) {
  Diagnosis d = sample::diagnosis();
  d.residual_unknown = true;
  d.depends_on = {"time"};
  d.not_separable.clear();
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("that structure depends on <b>time</b>"));
}

}  // namespace
}  // namespace forcegate
