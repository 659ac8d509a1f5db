// A film that is far steeper at low load than on average is at the low end of its converter as soon as it is let go. Nothing is lost there.

#include "hil/diagnose/raw/floor_by_force.h"

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

TEST(FloorByForce, BelongsWhereTheOthersOfThatForceAreToo) {
  std::vector<double> F, U;
  for (int i = 0; i < 1000; ++i) {
    F.push_back(0.004 * i);
    U.push_back(i < 50 || i == 500 ? 0.0 : 1.0);
  }
  const FloorByForce floor(F, U, 0.01, 0.02);
  EXPECT_TRUE(floor.belongs_there(0.1));
  EXPECT_FALSE(floor.belongs_there(2.0));
  EXPECT_FALSE(floor.belongs_there(9.0));
}

// Finger presses on an FSR in a divider, in codes of ten bits; every `lost_every`th sample is lost.
Campaign presses(int lost_every) {
  const auto force = [](double t) {
    const double x = std::fmod(t, 4.0);
    return x < 1.6 ? (2.0 + std::sin(0.13 * t)) * std::pow(std::sin(3.14159265358979 * x / 1.6), 2) : 0.0;
  };
  Campaign c = recording(100.0, 18000, force, [&](const std::vector<double>&, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double conductance = 1e-4 * std::pow(F[i], 0.8), divided = 3e4 * conductance / (1.0 + 3e4 * conductance);
      U.push_back(lost_every > 0 && static_cast<int>(i) % lost_every == 0 ? 0.0 : std::floor(1024.0 * divided));
    }
    return U;
  }, 0.0);
  Rng rng(5, "reference");
  for (double& f : c.records.front().trace.find("F_ref")->value) f += 0.004 * rng.normal();
  return c;
}

TEST(FloorByForce, ReleasesOfAnFsrInADividerAreNoDropouts) {
  const auto dropped = [](const Campaign& c) {
    const std::vector<HealthClaim> claims = claims_of_samples(c);
    return std::ranges::find(claims, "dropouts", &HealthClaim::effect) != claims.end();
  };
  EXPECT_FALSE(dropped(presses(0)));
  EXPECT_TRUE(dropped(presses(97)));
}

}  // namespace
}  // namespace forcegate::diagnose
