#include "hil/model/decay_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/model/base_law.h"
#include "hil/model/model.h"

namespace forcegate {
namespace {

// Triangles of 2 s; none from `pause_s` on for as long.
RecordInput triangles(double duration_s, double pause_s = 1e9) {
  RecordInput r;
  r.dynamic = true;
  double phase_s = 0.0, travel_N = 0.0;
  for (double t = 0.0; t < duration_s; t += 0.02) {
    const bool pauses = t >= pause_s && t < 2.0 * pause_s;
    const double at = std::fmod(phase_s, 2.0);
    r.t_s.push_back(t);
    r.F_N.push_back(1.0 + (at < 1.0 ? at : 2.0 - at));
    r.travel_N.push_back(travel_N);
    if (!pauses) phase_s += 0.02, travel_N += 0.02;
  }
  r.F_min_N = 1.0;
  r.A_N = 0.5;
  r.f_Hz = 0.5;
  return r;
}

TEST(DecayClock, UnderEvenCyclingTimeAndLoadingAreOne) {
  const RecordInput r = triangles(60.0);
  for (const double share : {0.0, 0.5, 1.0}) {
    const DecayClock clock(r, share);
    for (std::size_t i = 0; i < r.rows(); i += 100) EXPECT_NEAR(clock(i), r.t_s[i], 1e-3) << share;
  }
  EXPECT_LT(unevenness_of_loading(r), 1e-3);
}

TEST(DecayClock, StandsWhereTheLoadPausesAsFarAsItGoesWithIt) {
  const RecordInput r = triangles(60.0, 20.0);
  const auto at = [&](double share, double t_s) { return DecayClock(r, share)(static_cast<std::size_t>(t_s / 0.02 + 0.5)); };
  EXPECT_NEAR(at(1.0, 39.0) - at(1.0, 21.0), 0.0, 1e-9);
  EXPECT_NEAR(at(0.5, 39.0) - at(0.5, 21.0), 9.0, 1e-9);
  EXPECT_NEAR(at(1.0, 59.98), 39.98, 0.03) << "the cycling it has seen, without the pause";
  EXPECT_GT(unevenness_of_loading(r), 0.1);
}

TEST(DecayClock, IsTheTimeBeforeTheStartAndWhereNothingMoves) {
  RecordInput r = triangles(60.0, 20.0);
  r.onset_s = 10.0;
  EXPECT_NEAR(DecayClock(r, 1.0)(100), -8.0, 1e-9);
  RecordInput still = r;
  still.A_N = 0.0;
  EXPECT_NEAR(DecayClock(still, 1.0)(2000), 30.0, 1e-9);
  r.travel_N.clear();
  EXPECT_NEAR(DecayClock(r, 1.0)(2000), 30.0, 1e-9);
  EXPECT_EQ(unevenness_of_loading(r), 0.0);
}

TEST(DecayClock, TheDecayKeepsToIt) {
  RecordInput r = triangles(60.0, 20.0);
  set_decay(r, {.loading_share = 1.0});
  EXPECT_EQ(r.decay[1050], r.decay[1950]);
  EXPECT_LT(r.decay[2900], r.decay[1950]);
  set_decay(r, {});
  EXPECT_LT(r.decay[1950], r.decay[1050]);
}

TEST(DecayClock, AModelFileKeepsItAndRefusesWhatIsNoShare) {
  Model m;
  m.law.loading_share = 0.5;
  const auto again = parse_model(write_model(m), "m.toml");
  ASSERT_TRUE(again.has_value()) << again.error().text;
  EXPECT_EQ(again->law.loading_share, 0.5);
  EXPECT_EQ(write_model(Model{}).find("loading_share"), std::string::npos) << "the paper's clock is said by nothing";
  for (const char* wrong : {"1.5", "-0.1", "{ value = 0.5, unit = \"s\" }"}) {
    const auto refused = parse_model(std::string("[law]\nloading_share = ") + wrong + "\n", "m.toml");
    ASSERT_FALSE(refused.has_value()) << wrong;
    EXPECT_NE(refused.error().text.find("loading_share"), std::string::npos) << refused.error().text;
  }
}

}  // namespace
}  // namespace forcegate
