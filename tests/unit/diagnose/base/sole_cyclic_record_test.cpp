// One record of a campaign is cyclic, and nobody wrote down that it does not decay.

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

Record record_of(const std::string& name, double rate_Hz, std::uint64_t seed, const std::function<double(double)>& force_N) {
  Record r;
  r.name = name;
  r.role = RecordRole::fit;
  TimeBase clock;
  std::vector<double> F, U;
  Rng rng(seed, "sole");
  double late_N = force_N(0.0);
  for (int i = 0; i < static_cast<int>(120.0 * rate_Hz); ++i) {
    const double t = i / rate_Hz, f = force_N(t);
    late_N += (f - late_N) * -std::expm1(-1.0 / (rate_Hz * 0.6));
    clock.t_s.push_back(t);
    F.push_back(f + 0.01 * rng.normal());
    U.push_back(0.1 + 0.04 * (0.8 * f + 0.2 * late_N) + 0.0004 * rng.normal());
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
  return r;
}

TEST(SoleCyclicRecord, TellsOfItsOwnDecayAndNotAgainstTheEffectThatItShows) {
  Campaign c;
  c.name = "made";
  const auto sine = [](double f_Hz, double t) { return std::sin(2.0 * std::numbers::pi * f_Hz * t); };
  for (int k = 0; k < 3; ++k)
    c.records.push_back(record_of("r" + std::to_string(k), 50.0, static_cast<std::uint64_t>(k + 1), [&](double t) { return 10.0 + 8.0 * sine(1.0 / 30.0, t + 2.0); }));
  c.records.push_back(record_of("sines", 200.0, 9, [&](double t) { return 10.0 + 7.2 * sine(t < 60.0 ? 0.2 : 4.0, t); }));
  const Diagnosis d = answer(std::move(c));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "lag") << told(d);
  EXPECT_GT(d.findings.front().probability, 0.9) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
