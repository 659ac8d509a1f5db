#include "hil/diagnose/choose/reference_witness.h"

#include <gtest/gtest.h>

#include "tests/unit/diagnose/turning_bench.h"

namespace forcegate::diagnose {
namespace {

double bent(double F) { return F > 2.2 ? F + 0.03 * (F - 2.2) : F; }

// The amplifier of the load cell changes its range: against it the output and the spring are bent alike.
TEST(ReferenceWitness, AReferenceThatIsBentIsNeitherTheSensorsCurveNorTheSprings) {
  Bench bench;
  bench.reads_N = bent;
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(claims(d), "");
  EXPECT_EQ(to_string(d.verdict), "unknown");
  ASSERT_FALSE(d.follows.empty());
  EXPECT_EQ(d.follows.front(), "an error of the reference itself");
  EXPECT_FALSE(d.errors.contains("F")) << "nothing that is told lowers it";
}

// What the reference has in common with the rig's law alone, or with the output alone, is no fault of its own.
TEST(ReferenceWitness, ACurveOfTheSensorOrOfTheSpringKeepsItsName) {
  Bench of_sensor;
  of_sensor.push = [](double F, double, double) { return bent(F) - F; };
  EXPECT_EQ(claims(diagnose(of_sensor)), "static_nonlinearity ");
  Bench of_spring;
  of_spring.machine_N = [](double F) { return bent(F) - F; };
  EXPECT_EQ(claims(diagnose(of_spring)), "spring_nonlinearity ");
}

// Both at once, and not in one size.
TEST(ReferenceWitness, CurvesOfSensorAndSpringAreTwoFindings) {
  Bench bench;
  bench.push = [](double F, double, double) { return 0.01 * F * F; };
  bench.machine_N = [](double F) { return bent(F) - F; };
  const std::string found = claims(diagnose(bench));
  EXPECT_NE(found.find("static_nonlinearity"), std::string::npos) << found;
  EXPECT_NE(found.find("spring_nonlinearity"), std::string::npos) << found;
}

// On a wheel that turns evenly a loop of the film goes nearly as the sine of the angle, and so would a zero of the angle that the rig does not show.
TEST(ReferenceWitness, ALoopOfTheSensorOnAnEvenWheelIsItsOwn) {
  Bench bench;
  bench.turns_Hz = {0.1, 0.4, 0.2, 1.5, 0.6, 3.0, 0.9};
  bench.push = [](double, double, double th) { return -0.02 * std::tanh(12.0 * std::sin(th)); };
  const Diagnosis d = diagnose(bench);
  EXPECT_EQ(std::ranges::count(d.follows, "an error of the reference itself"), 0);
  EXPECT_EQ(std::ranges::count_if(d.notes, [](const std::string& note) { return note.starts_with("the reference itself is off"); }), 0);
}

}  // namespace
}  // namespace forcegate::diagnose
