#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// Presses of many heights, each of which takes 0.2 s.
double steps(double t) {
  constexpr double kHeights[] = {0.4, 3.2, 1.1, 4.6, 2.0, 0.7, 3.9, 1.6, 0.5, 2.7, 4.3, 1.3};
  constexpr double kHold_s = 0.8, kPress_s = 0.2;
  const auto at = [&](double press) { return kHeights[static_cast<std::size_t>(press) % std::size(kHeights)]; };
  const double press = std::floor(t / kHold_s), done = std::min(1.0, (t - press * kHold_s) / kPress_s);
  return std::lerp(at(press), at(press + 1.0), 0.5 - 0.5 * std::cos(3.14159265358979 * done));
}

// A capacitor that is charged through the film, whose conductance grows with the force, and a resistor.
std::vector<double> behind_film(const std::vector<double>& t, const std::vector<double>& F) {
  std::vector<double> y{2.0 * F.front()};
  for (std::size_t i = 1; i < F.size(); ++i) {
    const double tau_s = 0.003 * (0.3 + 1.0 / (0.05 + F[i] / 4.0));
    y.push_back(y.back() + (2.0 * F[i] - y.back()) * -std::expm1(-(t[i] - t[i - 1]) / tau_s));
  }
  return y;
}

// A lone file says nothing of its sensor, and strengths may have either sign there: a lead may not, or it is the lag of a pole.
TEST(LeadOrLag, AnOutputThatLagsMoreAtLowLoadIsNoLead) {
  const Diagnosis d = answer(recording(200.0, 24000, steps, behind_film, 0.01));
  EXPECT_LT(probability(d, "piezocapacitance"), 0.1) << told(d);
  EXPECT_GE(probability(d, "rc"), 0.9) << told(d);
}

// Layers of a load's own hurry, which is no 1/F: unloaded they take half as long again, pressed two thirds of it.
std::vector<double> seating(const std::vector<double>& t, const std::vector<double>& F) {
  std::vector<double> y{2.0 * F.front()};
  for (std::size_t i = 1; i < F.size(); ++i) {
    const double tau_s = 0.012 * (0.6 + 0.8 * std::exp(-F[i] / 2.0));
    y.push_back(y.back() + (2.0 * F[i] - y.back()) * -std::expm1(-(t[i] - t[i - 1]) / tau_s));
  }
  return y;
}

TEST(LeadOrLag, LayersThatSeatSoonerUnderLoadAreNoCapacitance) {
  const Diagnosis d = answer(recording(200.0, 24000, steps, seating, 0.002));
  EXPECT_GE(probability(d, "lag"), 0.7) << told(d);
  EXPECT_LT(probability(d, "rc"), 0.3) << told(d);
}

// Charge that goes with the logarithm of the force.
TEST(LeadOrLag, OneThatLeadsIs) {
  const Diagnosis d = answer(recording(
      200.0, 24000, steps,
      [](const std::vector<double>& t, const std::vector<double>& F) {
        std::vector<double> y;
        double q = 0.0, slow = std::log(F.front() + 0.3);
        for (std::size_t i = 0; i < F.size(); ++i) {
          q = std::log(F[i] + 0.3);
          if (i > 0) slow += (q - slow) * -std::expm1(-(t[i] - t[i - 1]) / 0.012);
          y.push_back(2.0 * F[i] + 0.3 * (q - slow));
        }
        return y;
      },
      0.01));
  EXPECT_GE(probability(d, "piezocapacitance"), 0.9) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
