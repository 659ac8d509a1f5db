// A press with a spindle: the angle of its screw goes over many turns, and the force along it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/model/spindle.h"
#include "tests/unit/diagnose/turning_bench.h"

namespace forcegate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

// The wheel's bench with a screw in its place: what its spring makes of the angle is the way of the screw.
// `play_rad`: half that of its nut, which the motor goes ahead of the way.
Campaign pressed(const Bench& bench, double play_rad = 0.0) {
  constexpr double kWay_N = 0.05;  // newtons a radian
  Campaign c = turning(bench);
  for (Record& r : c.records) {
    for (Channel& channel : r.trace.channels)
      if (channel.name == "theta") {
        double before = 0.0, ahead = 0.0;
        for (double& th : channel.value) {
          const double way = c.bench.spring_N_per_mm * (*r.preload_mm + *r.eccentricity_mm * (1.0 - std::cos(th))) / kWay_N;
          if (way != before) ahead = way > before ? play_rad : -play_rad;
          before = way;
          th = way + ahead;
        }
      }
    std::erase_if(r.trace.channels, [](const Channel& channel) { return channel.name == "F_cmd"; });
    r.eccentricity_mm.reset();
    r.preload_mm.reset();
  }
  return c;
}

Diagnosis answer(const Bench& bench, double play_rad = 0.0) {
  auto out = diagnose_campaign(pressed(bench, play_rad), EngineOptions{});
  EXPECT_TRUE(out.has_value());
  return out ? *out : Diagnosis{};
}

TEST(Spindle, IsToldFromAWheelByTheWayOfTheForce) {
  const Diagnosis d = answer({});
  EXPECT_THAT(d.notes, Contains(HasSubstr("way of a spindle")));
  EXPECT_EQ(claims(d), "");
  EXPECT_EQ(to_string(d.verdict), "none");
  EXPECT_THAT(diagnose(Bench{}).notes, Not(Contains(HasSubstr("spindle")))) << "a wheel";
}

// A record whose force is `of_N` of the angle, over `arc_rad` from `from_rad` on.
bool read_as_spindle(double from_rad, double arc_rad, const std::function<double(double)>& of_N) {
  CampaignInput c;
  RecordInput r;
  double low_N = HUGE_VAL, high_N = -HUGE_VAL;
  for (int i = 0; i < 2000; ++i) {
    const double th = from_rad + arc_rad * 0.5 * (1.0 - std::cos(0.01 * i)), f = of_N(th);
    r.ok.push_back(1);
    r.theta_rad.push_back(th);
    r.cos_theta.push_back(std::cos(th));
    r.F_N.push_back(f + 0.001 * std::sin(37.0 * i));
    r.t_s.push_back(0.02 * i);
    low_N = std::min(low_N, f), high_N = std::max(high_N, f);
  }
  c.lowest_N = low_N;
  c.range_N = high_N - low_N;
  c.records.assign(3, r);
  return is_spindle(c);
}

TEST(Spindle, OfLessThanHalfATurnIsOneWhereNoPartOfAWheelIsAsStraight) {
  const auto screw = [](double th) { return 1.0 + 1.7 * th; };
  EXPECT_TRUE(read_as_spindle(0.2, 2.6, screw));
  EXPECT_FALSE(read_as_spindle(1.0, 1.0, screw)) << "a wheel is as straight there";
  for (double zero = 0.0; zero < 6.3; zero += 0.1)
    for (const double arc : {1.0, 1.6, 2.6}) EXPECT_FALSE(read_as_spindle(0.0, arc, [zero](double th) { return 3.0 - 2.0 * std::cos(th + zero); })) << zero << ' ' << arc;
}

TEST(Spindle, ShowsAContactThatOpens) {
  Bench bench;
  bench.lift_N = 0.6;
  EXPECT_EQ(claims(answer(bench)), "contact_loss ");
}

TEST(Spindle, ShowsASpringThatStiffens) {
  Bench bench;
  bench.rim_N = [](double th) { return 0.08 * std::pow(1.0 - std::cos(th), 2); };
  EXPECT_EQ(claims(answer(bench)), "spring_nonlinearity ");
}

TEST(Spindle, ShowsAPlayOfItsNut) {
  EXPECT_EQ(claims(answer({}, 1.0)), "backlash ");
}

TEST(Spindle, OfAReferenceThatReadsAFewMillisecondsLateIsNoPlay) {
  Bench bench;
  bench.reference_lag_s = 0.004;
  EXPECT_EQ(claims(answer(bench)), "");
}

}  // namespace
}  // namespace forcegate::diagnose
