// Axes of the pictures of a residual against one coordinate.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/report/diagnosis_figures.h"

namespace forcegate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(CoordinatePicture, spreads_cells_that_crowd_at_one_end) {
  ResidualMap map{.coordinate = "rate", .group = "rate", .unit = "N/s", .share = 0.1, .cells = {}, .sentence = ""};
  const auto scale_of = [&](std::initializer_list<double> x) {
    map.cells.clear();
    for (const double at : x) map.cells.push_back({at, 0.01, 0.001, 100, 12});
    return coordinate_figure(map, nullptr, "V").panels().front().x_axis.scale;
  };
  EXPECT_EQ(scale_of({-7.8, -0.2, -0.1, -0.01, 0.0, 0.01, 0.1, 0.2, 7.7}), figures::Scale::symmetric_log);
  EXPECT_EQ(scale_of({0.001, 0.01, 0.02, 0.1, 0.2, 0.3, 11.0}), figures::Scale::logarithmic);
  EXPECT_EQ(scale_of({0.5, 1.0, 1.4, 2.0, 2.6, 3.0, 3.4}), figures::Scale::linear);
}

TEST(CoordinatePicture, has_a_conductance_in_the_unit_of_its_size) {
  ResidualMap map{.coordinate = "output", .group = "output", .unit = "S", .share = 0.1, .cells = {}, .sentence = ""};
  for (const double at : {2e-5, 4e-5, 6e-5, 8e-5}) map.cells.push_back({at, 1e-6, 1e-7, 100, 12});
  const figures::Figure figure = coordinate_figure(map, nullptr, "S");
  EXPECT_EQ(figure.panels().front().x_axis.unit, "\u00b5S");
  EXPECT_THAT(figure.svg(figures::Figure::Target::embedded), AllOf(HasSubstr(">80<"), Not(HasSubstr("0.00002"))));
}

}  // namespace
}  // namespace forcegate
