// A record that stands far above the noise: it must neither be overlooked nor hide what the others show.

#include <cmath>
#include <functional>
#include <numbers>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// A voltage that couples in from a wheel that nobody reads.
double saw_V(double t_s) { return std::fmod(t_s / 0.73, 1.0) - 0.5; }

TEST(FarAbove, ALoneRecordThatTheModelDoesNotForetellIsUnknown) {
  const Diagnosis d = answer(make_campaign(61, [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U = straight(t, F, record);
    if (record == 6)
      for (std::size_t i = 0; i < U.size(); ++i) U[i] += 1.5 * saw_V(t[i]);
    return U;
  }));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_NE(told(d).find("far above what their instruments may leave: r6"), std::string::npos) << told(d);
}

// The film goes on growing after every step, by a power of the time; one fast record has the wheel in it too.
TEST(FarAbove, ARecordWithAFaultOfItsOwnDoesNotHideWhatTheOthersShow) {
  const Diagnosis d = answer(make_campaign(62, [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    constexpr double kTau_s[] = {2.0, 9.0, 40.0};
    double held[] = {F[0], F[0], F[0]};
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      double growth = 0.0;
      for (int k = 0; k < 3; ++k) {
        held[k] += (F[i] - held[k]) * -std::expm1(-0.005 / kTau_s[k]);
        growth += held[k] - F[0];
      }
      U.push_back(2.0 * F[i] + 0.2 + 0.06 * growth + (record == 7 ? 2.0 * saw_V(t[i]) : 0.0));
    }
    return U;
  }));
  EXPECT_GE(probability(d, "creep"), 0.5) << told(d);
  EXPECT_TRUE(d.residual_unknown) << told(d);
}

// Eight records, six of them under cyclic load, whose swing falls by `left` of seconds since the start.
Campaign decaying(const std::function<double(double)>& left) {
  Campaign c;
  c.name = "powers";
  c.bench.reference_resolution_N = 0.005;
  Rng rng(63, "powers");
  for (int k = 0; k < 8; ++k) {
    Record r;
    r.name = "r" + std::to_string(k);
    const bool cyclic = k % 4 != 0;
    r.dynamic = cyclic;
    r.kind = cyclic ? "sine" : "ramp";
    r.start_s = 9000.0 * k;
    TimeBase clock;
    std::vector<double> F, U;
    for (int i = 0; i < (cyclic ? 40000 : 6000); ++i) {
      const double t = i / 50.0, up = 1.4 * (1.0 - std::cos(2.0 * std::numbers::pi * t * (cyclic ? 0.5 + 0.1 * k : 0.02)));
      clock.t_s.push_back(t);
      F.push_back(0.5 + up + 0.002 * rng.normal());
      U.push_back(1.2 + 2.0 * up * (cyclic ? left(t) : 1.0) + 0.003 * rng.normal());
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

Diagnosis of_decay(const std::function<double(double)>& left) { return answer(decaying(left)); }

TEST(FarAbove, ADecayThatIsNoExponentialIsTold) {
  const Diagnosis d = of_decay([](double t_s) { return 1.0 / std::sqrt(1.0 + t_s / 20.0); });
  EXPECT_NE(told(d).find("no single exponential"), std::string::npos) << told(d);
}

// The film grows along with its load by an equation of the user's own, which is fitted: what it leaves of a straight line is no matter of the decay.
TEST(FarAbove, ADecayThatAnEquationOfTheModelMakesIsNotTold) {
  const auto film = [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double y = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      if (i > 0) y += (F[i] - y) * -std::expm1((t[i - 1] - t[i]) / 20.0);
      U.push_back(2.0 * (F[i] + 0.05 * y) + 0.05);
    }
    return U;
  };
  Campaign c = make_campaign(64, film, 0.003);
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    r.kind = "sine", r.dynamic = true;
    std::vector<double>& F = r.trace.find("F_ref")->value;
    const std::vector<double>& t = r.trace.time_bases[0].t_s;
    for (std::size_t i = 0; i < F.size(); ++i) F[i] = t[i] < 10.0 ? 0.0 : (1.5 - std::cos(2.0 * std::numbers::pi * (0.1 + 0.05 * static_cast<double>(k)) * (t[i] - 10.0))) * std::min(1.0, (t[i] - 10.0) / 10.0);
    Rng rng(65 + k, "film");
    std::vector<double> U = film(t, F, 0);
    for (double& u : U) u += 0.003 * rng.normal();
    r.trace.find("U")->value = U;
    for (double& f : F) f += 0.003 * rng.normal();
  }
  EngineOptions options;
  options.threads = 1;
  options.law.decays = false;
  options.user_effects = {{"mine", {{"k", "", 0.05, 0.001, -1e300, 1e300, 0.0}, {"tau", "s", 20.0, 0.1, 0.5, 5000.0, 0.0}}, {{"x", "(F - x) / tau"}}, "k * x"}};
  options.in_model = {"mine"};
  const auto d = diagnose_campaign(std::move(c), options);
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_EQ(told(*d).find("no single exponential"), std::string::npos) << told(*d);
}

// Slow from the start on: the law of the model is worse than none.
TEST(FarAbove, MaximaThatDecayAlongAnotherLawAreNotNothing) {
  const Diagnosis d = of_decay([](double t_s) { return 1.0 - 0.05 * std::log1p(t_s / 2.0); });
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
