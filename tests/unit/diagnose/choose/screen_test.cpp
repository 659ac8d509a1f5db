#include "hil/diagnose/choose/screen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// Two families that explain the same. One may have any strength, the other that of the column itself only, so that three of its four
// shapes lie beyond its bounds. Its prior was spread over the four as well.
TEST(Screen, AShapeBeyondItsBoundsHadAShareOfThePrior) {
  const std::vector<double> shapes{0.5, 1.0, 2.0, 4.0};
  EffectKind free, bound;
  free.name = "free";
  free.forms.resize(1);
  free.forms.front().strength = {{"c", "1", -2.0, 2.0, 0.0, "share"}};
  bound = free;
  bound.name = "bound";
  bound.forms.front().least = 0.9;
  bound.forms.front().most = 1.1;

  const auto n_shapes = static_cast<int>(shapes.size());
  ResidualChannel channel = channel_of_lines(2 * n_shapes, 1.0);
  channel.gain_of_unit = 1.0;
  for (int k = 0; k < 2 * n_shapes; ++k) {
    const EffectKind& kind = k < n_shapes ? free : bound;
    const double shape = shapes[static_cast<std::size_t>(k % n_shapes)];
    channel.candidates.push_back({&kind, &kind.forms.front(), {shape}, k, 1});
    channel.variants.push_back({k, {k}});
    channel.problem.column_prior_sd[k] = 1.0 / shape;  // the same size of the effect
  }
  Rng rng(5, "screen");
  for (int record = 0; record < 4; ++record) {
    constexpr int kRows = 400;
    Eigen::MatrixXd rows(kRows, 2 + 2 * n_shapes + 1);
    for (int i = 0; i < kRows; ++i) {
      const double force = i / static_cast<double>(kRows), effect = 0.03 * std::sin(25.0 * force);
      rows(i, 0) = force;
      rows(i, 1) = 1.0;
      for (int k = 0; k < 2 * n_shapes; ++k) rows(i, 2 + k) = shapes[static_cast<std::size_t>(k % n_shapes)] * effect;
      rows(i, rows.cols() - 1) = force + effect + 0.01 * rng.normal();
    }
    add_record(channel, rows, 80.0, 1e-4, 1e-4);
  }
  const ScreenResult result = screen(channel, {}, {}, nullptr, 1);
  ASSERT_EQ(result.families.size(), 2u);
  EXPECT_EQ(result.families.front().kind->name, "free");
  EXPECT_GT(result.families.front().gain, 20.0);
  EXPECT_NEAR(result.families[0].gain - result.families[1].gain, std::log(4.0), 0.1);
}

// Two records come down to a gap at a tenth of the range, three stay above it, and one of these rests at it for a while. A hinge that is a little
// off leaves a tenth of what the two show, and a few rows of the quiet one that speak against it.
TEST(Screen, RecordsThatShowMostAreNotOutvotedByThoseThatAreExact) {
  constexpr double kGap = 0.1, kHinge = 0.112, kNoise = 5e-4;
  EffectKind gap;
  gap.name = "gap";
  gap.forms.resize(1);
  gap.forms.front().strength = {{"c", "1", -2.0, 2.0, 0.0, "share"}};
  ResidualChannel channel = channel_of_lines(1, 1.0);
  channel.gain_of_unit = 1.0;
  channel.candidates.push_back({&gap, &gap.forms.front(), {kHinge}, 0, 1});
  channel.variants.push_back({0, {0}});
  Rng rng(7, "gap");
  constexpr int kRows = 1000;
  for (int record = 0; record < 5; ++record) {
    Eigen::MatrixXd rows(kRows, 4);
    for (int i = 0; i < kRows; ++i) {
      const double x = i / static_cast<double>(kRows);
      const double force = record < 2 ? x : record == 4 && i < 170 ? kGap : 0.25 + 0.6 * x;
      rows(i, 0) = force;
      rows(i, 1) = 1.0;
      rows(i, 2) = -std::min(force, kHinge);
      rows(i, 3) = force - std::min(force, kGap) + kNoise * rng.normal();
    }
    add_record(channel, rows, 60.0, kNoise * kNoise, kNoise * kNoise);
  }
  const ScreenResult result = screen(channel, {}, {}, nullptr, 1);
  ASSERT_EQ(result.families.size(), 1u);
  EXPECT_GT(result.families.front().gain, 50.0);
}

}  // namespace
}  // namespace forcegate::diagnose
