#include "hil/diagnose/choose/refine.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

EffectForm of_one_shape() {
  EffectForm out;
  out.name = "made";
  out.shape = {{"x", "N", 1e-3, 100.0, 1.0, "a shape"}};
  return out;
}

// Evidence in thousands of nats stands on a peak far narrower than the grid.
TEST(Climb, FindsAPeakThatIsNarrowerThanTheGrid) {
  for (const double top : {2.43, 2.55, 2.7, 3.1}) {
    double best = -1e300, at = 0.0;
    climb(of_one_shape(), {2.4}, [&](const std::vector<double>& shape) {
      const double gain = -1000.0 * std::log1p(std::pow((shape[0] - top) / (0.01 * top), 2.0));
      if (gain > best) best = gain, at = shape[0];
      return gain;
    });
    EXPECT_NEAR(at, top, 0.002 * top);
  }
}

// Two shapes that make up for each other: along either alone the way up ends on the ridge.
TEST(Climb, FollowsARidge) {
  EffectForm form = of_one_shape();
  form.shape.push_back({"y", "1", 1e-3, 100.0, 1.0, "another"});
  double best = -1e300;
  climb(form, {2.4, 0.8}, [&](const std::vector<double>& shape) {
    const double x = std::log(shape[0] / 3.0), y = std::log(shape[1] / 0.6);
    const double gain = -200.0 * (x + y) * (x + y) - 60.0 * (x - y) * (x - y);
    best = std::max(best, gain);
    return gain;
  });
  EXPECT_GT(best, -0.5);
}

TEST(Climb, AsksLittleOfAFlatTop) {
  int asked = 0;
  climb(of_one_shape(), {2.4}, [&](const std::vector<double>& shape) {
    ++asked;
    return -0.5 * std::pow(std::log(shape[0] / 2.5), 2.0);
  });
  EXPECT_LE(asked, 8);
}

const Finding* found(const Diagnosis& d, const char* effect) {
  const auto at = std::ranges::find(d.findings, effect, &Finding::effect);
  return at == d.findings.end() ? nullptr : &*at;
}

double value_of(const Finding& f, const char* parameter) {
  const auto at = std::ranges::find(f.parameters, parameter, &FoundParameter::name);
  return at == f.parameters.end() ? 0.0 : at->value;
}

// Nearest to the grid is another form; the right one lies between its points.
TEST(RefineFamily, TheRightFormIsTakenThoughTheGridHasANearerOne) {
  for (const double F0_N : {0.7, 1.0, 1.3}) {
    const Diagnosis d = answer(make_campaign(81, [=](const std::vector<double>&, const std::vector<double>& F, int) {
      std::vector<double> U;
      for (const double f : F) U.push_back(0.2 + 2.0 * std::max(0.0, f - F0_N));
      return U;
    }));
    const Finding* gap = found(d, "dead_zone");
    ASSERT_NE(gap, nullptr) << told(d);
    EXPECT_EQ(gap->form, "hard") << F0_N << ": " << told(d);
    EXPECT_NEAR(value_of(*gap, "F0_N"), F0_N, 0.01) << told(d);
    EXPECT_NEAR(value_of(*gap, "c"), 1.0, 0.03) << told(d);
  }
}

TEST(RefineFamily, ARailIsFoundWhereItIs) {
  const Diagnosis d = answer(make_campaign(82, [](const std::vector<double>&, const std::vector<double>& F, int) {
    std::vector<double> U;
    for (const double f : F) U.push_back(std::min(0.2 + 2.0 * f, 5.5));
    return U;
  }));
  const Finding* rail = found(d, "clipping");
  ASSERT_NE(rail, nullptr) << told(d);
  EXPECT_NEAR(value_of(*rail, "Wr_N"), 2.65, 0.02) << told(d);
  EXPECT_NEAR(value_of(*rail, "c"), 1.0, 0.02) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
