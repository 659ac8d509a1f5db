#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/built_header.h"
#include "hil/model/compensator/compensator.h"

namespace forcegate {
namespace {

// A firmware cannot ask its converter again: one bad sample must not spoil those behind it.
TEST(CompensatorInput, LeavesOutASampleThatIsNoNumberAndKeepsItsState) {
  Model model;
  model.name = "tested";
  model.frame.span_N = 4.0;
  model.law.gain_N_per_V = 0.5;
  model.law.offset_N = 0.12;
  ModelEffect creep{"creep", "power_law", {}, {}}, loop{"hysteresis", "play_bank", {}, {}};
  creep.strength = {{"growth_per_decade", "1", 0.03, 0, -1e9, 1e9, 0}};
  creep.shape = {{"exponent", "1", 0.12, 0, -1e9, 1e9, 0}};
  for (const double width_N : {0.02, 0.03, 0.05, 0.04, 0.03, 0.02}) loop.strength.push_back({"w", "1", width_N, 0, -1e9, 1e9, 0});
  model.effects = {creep, loop};
  const auto made = make_compensator(model, {});
  ASSERT_TRUE(made) << made.error().to_text();
  const auto built = BuiltHeader::build(made->header);
  ASSERT_TRUE(built) << built.error().to_text();
  std::vector<float> u(400), shrink(400, 0.9f), low(400, 0.3f), T(400, NAN);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 1.0f + std::sin(0.05f * static_cast<float>(i));
  const std::vector<float> good = (*built)->run(u, shrink, low, false, T);
  EXPECT_TRUE(std::isfinite(good.back())) << "a temperature that is not needed is not read";
  const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f};
  for (const float value : bad) {
    auto u_bad = u, shrink_bad = shrink, low_bad = low;
    u_bad[100] = shrink_bad[150] = low_bad[200] = value;
    shrink_bad[250] = 0.0f, shrink_bad[300] = -1.0f;
    const std::vector<float> F = (*built)->run(u_bad, shrink_bad, low_bad, false, T);
    for (const std::size_t i : {100, 150, 200, 250, 300}) EXPECT_EQ(F[i], F[i - 1]) << i;
    EXPECT_NEAR(F.back(), good.back(), 2e-3f) << value;
  }
  u[0] = NAN;
  EXPECT_EQ((*built)->run(u, shrink, low, false, T).front(), 0.0f);
  EXPECT_NE(made->header.find("is left out"), std::string::npos);
}

}  // namespace
}  // namespace forcegate
