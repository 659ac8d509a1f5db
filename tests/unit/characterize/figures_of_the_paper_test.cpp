// What is drawn of the curves of a study.

#include "hil/report/characterization/figures_of_the_paper.h"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

namespace forcegate::test {
namespace {

using characterize::Curve;
using characterize::SensorStudy;

Curve cycles(const char* name, double f_Hz, double duration_s) {
  Curve c{name, {"t_s", "setpoint_N", "ati_N", "sensor_V"}, std::vector<std::vector<float>>(4)};
  for (double t = 0.0; t < duration_s; t += 0.1 / f_Hz) {
    const auto y = static_cast<float>(2.0 - std::cos(6.28318530718 * f_Hz * t));
    c.data[0].push_back(static_cast<float>(t));
    for (int k = 1; k < 4; ++k) c.data[static_cast<std::size_t>(k)].push_back(y);
  }
  return c;
}

std::vector<PaperPicture> pictures_of(Curve curve) {
  SensorStudy study;
  study.sensor = "flexiforce";
  study.exemplar.curves = {std::move(curve)};
  return figures_of_the_paper({study});
}

template <class T>
std::size_t how_many(const PaperPicture& picture) {
  std::size_t n = 0;
  for (const figures::Series& s : picture.figure.panels().front().series) n += std::holds_alternative<T>(s);
  return n;
}

TEST(FiguresOfThePaper, DrawCyclesThatCannotBeToldApartAsABand) {
  for (const char* name : {"fig6", "fig8", "fig10"}) {
    const auto dense = pictures_of(cycles(name, 0.5, 1200.0)), few = pictures_of(cycles(name, 0.05, 400.0));
    ASSERT_EQ(dense.size(), 1u) << name;
    EXPECT_GT(how_many<figures::BandSeries>(dense[0]), 0u) << name;
    EXPECT_EQ(how_many<figures::BandSeries>(few[0]), 0u) << name;
    EXPECT_GT(how_many<figures::LineSeries>(few[0]), 0u) << name;
  }
}

TEST(FiguresOfThePaper, SpeakOfOneSensorWhereThereIsOne) {
  const auto one = pictures_of(cycles("fig4", 0.01, 200.0));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].figure.title, "Calibration");
}

}  // namespace
}  // namespace forcegate::test
