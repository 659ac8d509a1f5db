#include "hil/diagnose/laws/no_input.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/base/rng.h"
#include "hil/diagnose/laws/drift.h"

namespace forcegate::diagnose {
namespace {

using Course = std::function<double(double)>;  // of time from 0 to 1

constexpr std::size_t kSamples = 30000;

std::vector<double> series(const Course& course, double noise, std::uint64_t seed) {
  Rng rng(seed, "no input");
  std::vector<double> out;
  for (std::size_t i = 0; i < kSamples; ++i) out.push_back(course(static_cast<double>(i) / kSamples) + noise * rng.normal());
  return out;
}

Record record_of(const Course& force, const Course& output, double noise_N, double noise_V, std::uint64_t seed = 1) {
  Record record;
  record.name = "r" + std::to_string(seed);
  record.trace.time_bases.push_back({"rig", {}, 0.0, {}, false});
  for (std::size_t i = 0; i < kSamples; ++i) record.trace.time_bases[0].t_s.push_back(0.02 * static_cast<double>(i));
  record.trace.channels.push_back({"F_ref", "N", "force", 0, series(force, noise_N, 2 * seed), {}});
  record.trace.channels.push_back({"U", "V", "voltage", 0, series(output, noise_V, 2 * seed + 1), {}});
  return record;
}

Campaign of(std::vector<Record> records) {
  Campaign campaign;
  campaign.name = "hold";
  campaign.records = std::move(records);
  return campaign;
}

Course steady(double level) {
  return [level](double) { return level; };
}

TEST(NoInput, ANoisyReferenceOfAConstantLoadIsNone) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const double noise_N : {0.0005, 0.004, 0.1}) {
      const Campaign hold = of({record_of(steady(2.0), steady(3.9), noise_N, 0.004, seed)});
      EXPECT_EQ(stillness_of_force(hold.records[0]), Stillness::noise);
      EXPECT_TRUE(is_drift_only(hold));
    }
  const auto d = diagnose_drift(of({record_of(steady(2.0), steady(3.9), 0.004, 0.004)}));
  ASSERT_TRUE(d);
  EXPECT_EQ(d->verdict, DiagnosisVerdict::none);
  ASSERT_GE(d->notes.size(), 2u);
  EXPECT_EQ(d->notes[0], "no record has an input that moves: only the drift of the output can be judged");
  EXPECT_NE(d->notes[1].find("no more than noise of its reference"), std::string::npos);
}

TEST(NoInput, AnOutputThatDriftsUnderIt) {
  const Campaign hold = of({record_of(steady(2.0), [](double x) { return 3.9 * (1.0 + 0.03 * x); }, 0.004, 0.004)});
  ASSERT_TRUE(is_drift_only(hold));
  const auto d = diagnose_drift(hold);
  ASSERT_TRUE(d);
  ASSERT_EQ(d->findings.size(), 1u);
  EXPECT_EQ(d->findings[0].form, "line");
  EXPECT_EQ(d->findings[0].side, "unknown");
}

TEST(NoInput, AReferenceWhoseZeroWandersUnderAConstantLoad) {
  const auto wander = [](double x) { return 2.0 + 0.01 * std::sin(9.0 * x); };
  EXPECT_EQ(stillness_of_force(record_of(wander, steady(3.9), 0.0004, 0.004)), Stillness::wanders);
  EXPECT_EQ(stillness_of_force(record_of(wander, [](double x) { return 3.9 * (1.0 + 0.03 * x); }, 0.0004, 0.004)), Stillness::wanders);
  EXPECT_EQ(stillness_of_force(record_of([](double x) { return 0.01 * std::log10(1.0 + 99.0 * x); }, [](double x) { return 0.06 * x; }, 0.0008, 0.004)), Stillness::wanders);
  const auto unloaded = [](double x) { return 0.01 * x; };
  EXPECT_EQ(stillness_of_force(record_of(unloaded, steady(0.0), 0.004, 0.004)), Stillness::wanders);
}

TEST(NoInput, NoiseBehindAFilterOfAnUnloadedReference) {
  Record record = record_of(steady(0.0), [](double x) { return 0.06 * x; }, 0.0, 0.004);
  std::vector<double>& force = record.trace.channels[0].value = series(steady(0.0), 0.1, 5);
  for (std::size_t i = 1; i < force.size(); ++i) force[i] = force[i - 1] + (force[i] - force[i - 1]) / 40.0;
  EXPECT_EQ(stillness_of_force(record), Stillness::wanders);
  force = series([](double x) { return 0.1 * std::sin(2000.0 * x); }, 0.001, 5);
  EXPECT_EQ(stillness_of_force(record), Stillness::moves);
}

TEST(NoInput, ASmallForceThatTheOutputFollowsIsOne) {
  for (const Course& small : {Course([](double x) { return 0.04 * x; }), Course([](double x) { return 0.01 * std::sin(40.0 * x); }),
                              Course([](double x) { return x > 0.5 ? 0.02 : 0.0; }), Course([](double x) { return std::fmod(x, 0.05) < 0.0005 ? 0.05 : 0.0; })})
    for (const double load : {0.5, 2.0})
      for (const double noise : {0.0008, 0.004}) {
        const auto force = [&](double x) { return load + small(x); };
        EXPECT_EQ(stillness_of_force(record_of(force, [&](double x) { return 2.0 * force(x); }, noise, noise)), Stillness::moves) << load << " " << noise;
      }
}

// The level of a load cell that was never tared tells nothing of the gain.
TEST(NoInput, AForceFarFromZeroThatTheOutputFollowsIsOne) {
  const auto stroke = [](double x) { return 1.5 + 1.5 * std::sin(60.0 * x) * std::cos(17.0 * x); };
  for (const double tare : {0.0, 40.0, -300.0})
    EXPECT_EQ(stillness_of_force(record_of([&](double x) { return tare + stroke(x); }, [&](double x) { return 0.6 * stroke(x); }, 0.004, 0.003)), Stillness::moves) << tare;
}

TEST(NoInput, TwoExponentialDriftsAreNotOneCourse) {
  const auto settles = [](double rate) { return [rate](double x) { return 20.0 + std::exp(-rate * x); }; };
  EXPECT_NE(stillness_of_force(record_of(settles(5.0), [](double x) { return 1.0 + 0.8 * std::exp(-6.0 * x); }, 0.004, 0.003)), Stillness::moves);
}

TEST(NoInput, AForceThatMovesWhileTheOutputDoesNotIsOne) {
  const auto ramp = [](double x) { return 4.0 * x; };
  EXPECT_EQ(stillness_of_force(record_of(ramp, steady(0.0), 0.004, 0.003)), Stillness::moves);
  EXPECT_EQ(stillness_of_force(record_of([](double x) { return 0.04 * x; }, steady(0.0), 0.0008, 0.003)), Stillness::moves);
}

TEST(NoInput, HoldsAtSeveralLoadsOrOneRecordThatMovesAreOne) {
  const Record low = record_of(steady(1.0), steady(1.9), 0.004, 0.004, 1), high = record_of(steady(2.0), steady(3.9), 0.004, 0.004, 2);
  EXPECT_TRUE(is_drift_only(of({high, record_of(steady(2.0), steady(3.9), 0.004, 0.004, 3)})));
  EXPECT_FALSE(is_drift_only(of({low, high})));
  EXPECT_FALSE(is_drift_only(of({high, record_of([](double x) { return 4.0 * x; }, [](double x) { return 8.0 * x; }, 0.004, 0.004)})));
}

TEST(NoInput, AWheelThatTurnsIsOneAndSoIsATemperatureThatTheOutputFollows) {
  const auto warm = [](double x) { return 23.0 + 3.0 * std::sin(14.0 * x); };
  Record record = record_of(steady(2.0), [&](double x) { return 3.9 + 0.02 * (warm(x) - 23.0); }, 0.004, 0.004);
  EXPECT_TRUE(is_drift_only(of({record})));
  record.trace.channels.push_back({"temp", "degC", "temperature", 0, series(warm, 0.02, 77), {}});
  EXPECT_FALSE(is_drift_only(of({record})));
  Record drifting = record_of(steady(2.0), [](double x) { return 3.9 + 0.1 * x; }, 0.004, 0.004);
  drifting.trace.channels.push_back({"temp", "degC", "temperature", 0, series(warm, 0.02, 77), {}});
  EXPECT_TRUE(is_drift_only(of({drifting})));
  drifting.trace.channels.push_back({"theta", "rad", "angle", 0, series([](double x) { return std::sin(40.0 * x); }, 0.001, 78), {}});
  EXPECT_FALSE(is_drift_only(of({drifting})));
}

TEST(NoInput, AnOutputAtItsRailIsAnErrorDespiteItsNoise) {
  const auto ramp = [](double x) { return 4.0 * x; };
  const auto at_rail = check_output_moves(of({record_of(ramp, steady(10.0), 0.004, 0.003)}));
  ASSERT_FALSE(at_rail);
  EXPECT_NE(at_rail.error().to_text().find("it stands at 10 V"), std::string::npos) << at_rail.error().to_text();
  EXPECT_TRUE(check_output_moves(of({record_of(ramp, [&](double x) { return 2.0 * ramp(x); }, 0.004, 0.003)})));
  EXPECT_TRUE(check_output_moves(of({record_of(ramp, [](double x) { return 0.01 * x; }, 0.004, 0.003)})));
  EXPECT_TRUE(check_output_moves(of({record_of(steady(2.0), steady(3.9), 0.004, 0.003)})));
}

// A furnace: sampled a few times a time constant, it answers samples later.
TEST(NoInput, AnOutputThatAnswersSamplesLaterHasAnInput) {
  Rng rng(7, "gas");
  Record record = record_of([](double) { return 0.0; }, [](double) { return 0.0; }, 0.0, 0.0);
  auto &clock = record.trace.time_bases[0].t_s, &F = record.trace.find("F_ref")->value, &U = record.trace.find("U")->value;
  constexpr std::size_t kSamplesOfGas = 300;
  clock.resize(kSamplesOfGas), F.resize(kSamplesOfGas), U.resize(kSamplesOfGas);
  double gas = 0.0, heat = 0.0, noise = 0.0;
  for (std::size_t i = 0; i < kSamplesOfGas; ++i) {
    clock[i] = 9.0 * static_cast<double>(i);
    gas += 0.3 * (2.5 * rng.normal() - gas);
    F[i] = gas;
    heat += 0.4 * (-(i >= 4 ? F[i - 4] : 0.0) - heat);
    noise = 0.8 * noise + 0.1 * rng.normal();
    U[i] = 53.0 + 2.0 * heat + noise;
  }
  EXPECT_FALSE(is_drift_only(of({record})));
}

}  // namespace
}  // namespace forcegate::diagnose
