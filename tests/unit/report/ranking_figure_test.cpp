// What the pictures of a diagnosis say of claims, and how long a name may be in them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/report/diagnosis_figures.h"
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

TEST(WaterfallFigure, WritesTheLongestNameOfAnEffectOut) {
  const figures::Figure figure = figures::waterfall("Error", "start", {{"static_nonlinearity", 1.0, 0.5}}, "now", "V", 0.1);
  EXPECT_THAT(figure.svg(figures::Figure::Target::embedded), HasSubstr("static_nonlinearity"));
}

}  // namespace
}  // namespace forcegate
