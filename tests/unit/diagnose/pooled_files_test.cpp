// A folder of bare files: loads of no pattern, nothing written down, and one file with a fault of its own, or all with a line that is not the mains'.

#include <gmock/gmock.h>

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kTurn = 2.0 * std::numbers::pi, kRate_Hz = 50.0;

using Fault = std::function<void(const std::vector<double>& t, const std::vector<double>& F, std::vector<double>& U)>;

Record file(int number, const Fault& fault) {
  Record r;
  r.name = "r" + std::to_string(number);
  TimeBase clock;
  std::vector<double> F, U;
  Rng rng(static_cast<std::uint64_t>(number), "pooled");
  const double phase = 1.7 * number;
  for (int i = 0; i < 15000; ++i) {
    const double t = i / kRate_Hz;
    clock.t_s.push_back(t);
    F.push_back(2.5 + std::sin(kTurn * 0.1 * t + phase) + 0.7 * std::sin(kTurn * 0.37 * t + 2.0 * phase) + 0.3 * std::sin(kTurn * 1.1 * t + 3.0 * phase));
    U.push_back(0.5 * F.back() + 0.1);
  }
  if (fault) fault(clock.t_s, F, U);
  for (double& u : U) u += 0.003 * rng.normal();
  for (double& f : F) f += 0.002 * rng.normal();
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
  return r;
}

Diagnosis answer_to(const std::vector<Fault>& faults) {
  Campaign c;
  c.name = "pooled";
  for (std::size_t k = 0; k < faults.size(); ++k) c.records.push_back(file(static_cast<int>(k) + 1, faults[k]));
  return answer(std::move(c));
}

void lags(const std::vector<double>&, const std::vector<double>& F, std::vector<double>& U) {
  double y = F[0];
  for (std::size_t i = 0; i < F.size(); ++i) {
    y += (F[i] - y) * -std::expm1(-1.0 / kRate_Hz / 0.15);
    U[i] = 0.5 * y + 0.1;
  }
}

Fault line(double f_Hz, double amplitude_V) {
  return [=](const std::vector<double>& t, const std::vector<double>&, std::vector<double>& U) {
    for (std::size_t i = 0; i < U.size(); ++i) U[i] += amplitude_V * std::sin(kTurn * f_Hz * t[i]);
  };
}

TEST(PooledFiles, ThatAreCleanMissNothing) {
  const Diagnosis d = answer_to({nullptr, nullptr});
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_THAT(d.notes, Not(Contains(HasSubstr("hum taken off"))));
}

// Three half periods of a sum of sines are alike now and then: a change of frequency, beside whose decay nothing counted.
TEST(PooledFiles, OneThatLagsIsNoNone) {
  const Diagnosis d = answer_to({lags, nullptr});
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  ASSERT_FALSE(d.far_above.empty());
  EXPECT_EQ(d.far_above.front().record, "r1");
  EXPECT_GT(d.far_above.front().times, 10.0);
}

TEST(PooledFiles, HumOfOneIsTakenOffAndTold) {
  const Diagnosis d = answer_to({line(10.0, 0.05), nullptr, nullptr});
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_THAT(d.notes, Contains(HasSubstr("hum taken off the output, in too few records for a finding: 0.05 V at 10 Hz of r1")));
}

TEST(PooledFiles, ALineThatIsNotTheMainsIsNoNoise) {
  const Diagnosis d = answer_to({line(13.3, 0.2), line(13.3, 0.2)});
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_THAT(d.follows, Contains(HasSubstr("a line at 13.3 Hz, 200 mV, that the force does not have")));
}

// 33 to 200 ms at one value, with a force that moves on smoothly: a reference that is restless there and a sensor that stands still.
TEST(PooledFiles, AnOutputThatIsHeldSaysNothingOfTheReference) {
  const Fault held = [](const std::vector<double>&, const std::vector<double>&, std::vector<double>& U) {
    Rng rng(5, "held");
    for (std::size_t i = 100; i + 200 < U.size(); i += 110 + static_cast<std::size_t>(60.0 * rng.uniform()))
      std::fill_n(U.begin() + static_cast<std::ptrdiff_t>(i), 10 + static_cast<std::ptrdiff_t>(60.0 * rng.uniform()), U[i]);
  };
  Campaign c;
  c.records.push_back(file(1, nullptr));
  Channel& U = c.records.front().trace.channels[1];
  held({}, {}, U.value);
  for (Channel& channel : c.records.front().trace.channels)
    for (double& v : channel.value) v = 1e-5 * std::round(1e5 * v);
  const Diagnosis d = answer(std::move(c));
  EXPECT_GE(probability(d, "dropouts"), 0.9) << told(d);
  EXPECT_LT(probability(d, "reference_noise"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
