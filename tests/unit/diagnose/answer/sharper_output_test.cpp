#include <cmath>
#include <numbers>

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

// Taps of 60 ms twice a second. The output follows F + lead F' - sharper (T/2 pi)^2 F'', of which the last is 0.15 of a tap's height where
// `sharper` is 0.15.
Campaign taps(std::uint64_t seed, double lead_s, double sharper) {
  constexpr double kTap_s = 0.06, kOmega = 2.0 * std::numbers::pi / kTap_s;
  Campaign c = make_campaign(seed, straight);
  Rng rng(seed, "taps");
  for (Record& r : c.records) {
    auto& F = r.trace.find("F_ref")->value;
    auto& U = r.trace.find("U")->value;
    const double height = rng.uniform(1.5, 3.5), low = rng.uniform(0.3, 1.0);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double t = static_cast<double>(i) / 200.0, x = std::fmod(t, 0.5), slow = low + 0.5 * std::abs(std::fmod(t / 20.0, 2.0) - 1.0);
      const bool in_tap = x < kTap_s;
      const double bell = in_tap ? 0.5 * height * (1.0 - std::cos(kOmega * x)) : 0.0;
      const double rate = in_tap ? 0.5 * height * kOmega * std::sin(kOmega * x) : 0.0;
      const double bend = in_tap ? 0.5 * height * std::cos(kOmega * x) : 0.0;  // F'' / omega^2
      F[i] = std::round((slow + bell + 0.006 * rng.normal()) / 0.025) * 0.025;
      U[i] = 2.0 * (slow + bell + lead_s * rate - sharper * bend) + 0.5 + 0.004 * rng.normal();
    }
    r.kind = "impact";
  }
  return c;
}

TEST(SharperOutput, AMassBetweenReferenceAndSensorIsNoLateReference) {
  const Diagnosis d = answer(taps(71, 0.0, 0.15));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  ASSERT_FALSE(d.follows.empty()) << told(d);
  EXPECT_NE(d.follows.front().find("sharper than the reference"), std::string::npos) << told(d);
  ASSERT_FALSE(d.maps.empty());
  EXPECT_GT(d.maps.front().share, 0.1) << "the map shows what was forgiven";
}

TEST(SharperOutput, ALateReferenceIs) {
  const Diagnosis d = answer(taps(71, 0.004, 0.0));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_NE(told(d).find("lead"), std::string::npos) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
