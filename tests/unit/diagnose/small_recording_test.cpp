// What a single short file of time, force and output can tell.

#include <numbers>

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

using Series = std::vector<double>;

// Up and down twice, `levels` steps each way, from no load.
std::function<double(double)> staircases(int levels, double dwell_s, double step_N) {
  return [=](double t) {
    const int k = static_cast<int>(t / dwell_s) % (2 * levels);
    return step_N * (k < levels ? k : 2 * levels - k);
  };
}

const Finding* claimed(const Diagnosis& d, const std::string& effect) {
  const auto found = std::ranges::find_if(d.findings, [&](const Finding& f) { return f.effect == effect && f.claimed(); });
  return found == d.findings.end() ? nullptr : &*found;
}

// Relays that switch at loads of their own, most of them about two: the loop is wide there and narrow between.
Series uneven_loop(const Series& x) {
  struct Relay {
    double up, down, weight;
    bool on;
  };
  std::vector<Relay> relays;
  Rng rng(3, "relays");
  for (int k = 0; k < 400; ++k) {
    const double centre = (k % 2 == 0 ? 1.3 : 3.3) + 0.25 * rng.normal(), half = 0.15 + 0.35 * rng.uniform();
    relays.push_back({centre + half, centre - half, 0.5 / 400.0, false});
  }
  Series y;
  for (const double v : x) {
    double sum = 0.0;
    for (Relay& r : relays) {
      r.on = v > r.up || (r.on && v > r.down);
      sum += r.on ? r.weight : 0.0;
    }
    y.push_back(0.2 + 0.5 * v + sum);
  }
  return y;
}

TEST(SmallRecording, ALoopThatIsWideAtSomeLoadsOnlyIsHysteresis) {
  Campaign c = recording(100.0, 10800, staircases(9, 6.0, 0.5), [](const Series&, const Series& x) {
    Series y = uneven_loop(x);
    // what the relays bend is the curve's business: the mean of both ways is taken off
    Series up, down;
    for (int k = 0; k <= 900; ++k) up.push_back(0.005 * k);
    down.assign(up.rbegin(), up.rend());
    Series both = up;
    both.insert(both.end(), down.begin(), down.end());
    const Series loop = uneven_loop(both);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto k = static_cast<std::size_t>(std::lround(x[i] / 0.005));
      y[i] += 0.2 + 0.5 * x[i] - 0.5 * (loop[k] + loop[loop.size() - 1 - k]);
    }
    return y;
  }, 0.002);
  Rng rng(5, "reference");
  for (double& F : c.records.front().trace.find("F_ref")->value) F = 0.005 * std::round((F + 0.004 * rng.normal()) / 0.005);
  const Diagnosis d = answer(std::move(c));
  ASSERT_NE(claimed(d, "hysteresis"), nullptr) << told(d);
  EXPECT_EQ(claimed(d, "hysteresis")->form, "preisach") << told(d);
  EXPECT_EQ(claimed(d, "adc_codes"), nullptr) << "few levels leave the bits free: " << told(d);
}

Campaign converted(double error, int bits) {
  const auto presses = [](double t) { return 2.2 + 1.3 * std::sin(0.7 * t) + 0.7 * std::sin(0.31 * t); };
  Campaign c = recording(100.0, 12000, presses, [](const Series&, const Series& x) { return x; }, 0.003);
  const double step = 5.0 / std::exp2(bits);
  for (double& v : c.records.front().trace.find("U")->value) {
    const double code = std::round(v / step) * step;
    v = code + (std::fmod(code, 5.0) >= 2.5 ? error : 0.0) - (std::fmod(code, 2.5) >= 1.25 ? 0.5 * error : 0.0);
  }
  return c;
}

// Nobody wrote down the converter's bits or range; its steps stand in the file.
TEST(SmallRecording, StepsOfTheReadingsTellTheRangeOfTheConverter) {
  const Diagnosis d = answer(converted(0.04, 10));
  ASSERT_NE(claimed(d, "adc_codes"), nullptr) << told(d);
  EXPECT_LT(d.error_after, 0.5 * d.error_before);
  EXPECT_EQ(answer(converted(0.0, 10)).verdict, DiagnosisVerdict::none);
}

TEST(SmallRecording, AZeroThatMovesIsListedAndNothingSaysWhose) {
  const auto presses = [](double t) { return 2.5 + 1.5 * std::sin(0.6 * t) * std::sin(0.17 * t); };
  const auto moving = [](double share) {
    return [=](const Series& t, const Series& x) {
      Series y;
      for (std::size_t i = 0; i < x.size(); ++i) y.push_back(0.2 + 0.5 * x[i] + share * std::log1p(t[i] / 20.0) + 0.3 * share * std::sin(0.02 * t[i]));
      return y;
    };
  };
  const Diagnosis d = answer(recording(50.0, 14000, presses, moving(0.03), 0.002));
  const auto drift = std::ranges::find(d.findings, "reference_drift", &Finding::effect);
  ASSERT_NE(drift, d.findings.end()) << told(d);
  EXPECT_FALSE(drift->claimed());
  EXPECT_FALSE(drift->side_witnessed);
  for (const Finding& f : answer(recording(50.0, 14000, presses, moving(0.0), 0.002)).findings) EXPECT_NE(f.effect, "reference_drift");
}

Campaign with_samples(int count, const std::function<double(double U, int k)>& spoilt) {
  const auto presses = [](double t) { return 2.4 - 2.0 * std::cos(0.8 * t); };
  Campaign c = recording(25.0, 3000, presses, [](const Series&, const Series& x) {
    Series y;
    for (const double v : x) y.push_back(0.1 + 0.5 * v);
    return y;
  }, 0.002);
  auto& U = c.records.front().trace.find("U")->value;
  for (int k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(150 + k * 2700 / count);
    U[i] = spoilt(U[i], k);
  }
  return c;
}

TEST(SmallRecording, AFewSpikesAllAlongItAreNoHandOnTheCable) {
  const auto spike = [](double U, int k) { return U + (k % 2 == 0 ? 0.7 : -0.3) - 0.02 * k; };
  EXPECT_NE(claimed(answer(with_samples(9, spike)), "outliers"), nullptr);
  EXPECT_EQ(claimed(answer(with_samples(3, spike)), "outliers"), nullptr);
}

TEST(SmallRecording, SamplesThatFallToTheLevelWithoutSensorAreLost) {
  const Diagnosis d = answer(with_samples(9, [](double, int) { return 0.205; }));
  EXPECT_NE(claimed(d, "dropouts"), nullptr) << told(d);
  EXPECT_EQ(claimed(d, "outliers"), nullptr) << told(d);
}

// Driven by noise about its resonance, a few samples a swing.
TEST(SmallRecording, PeaksOfAnOutputThatRingsAreNoOutliers) {
  Rng rng(19, "force");
  double wide = 0.0;
  const auto noise = [&](double t) { return (0.2 + t / 60.0) * (wide = 0.6 * wide + rng.normal()); };
  const Diagnosis d = answer(recording(600.0, 36000, noise, [](const Series&, const Series& x) {
    constexpr double kOmega = 2.0 * std::numbers::pi * 68.0, kDamping = 0.03;
    constexpr int kSteps = 16;
    Series y(x.size());
    double s = 0.0, v = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (int k = 0; k < kSteps; ++k) {
        v += (kOmega * kOmega * (x[i] - s) - 2.0 * kDamping * kOmega * v) / (600.0 * kSteps);
        s += v / (600.0 * kSteps);
      }
      y[i] = 0.3 * s;
    }
    return y;
  }, 0.001));
  EXPECT_EQ(claimed(d, "outliers"), nullptr) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
