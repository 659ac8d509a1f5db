// A press with a spindle: the angle of its screw goes over many turns, and the force along it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
