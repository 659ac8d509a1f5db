#include "hil/diagnose/raw/denoise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/base/rng.h"
#include "hil/trace/trace.h"

namespace forcegate::diagnose {
namespace {

double rms(const std::vector<double>& a, const std::vector<double>& b, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(to - from));
}

struct Noisy {
  std::vector<double> truth, seen;
};

template <class Curve>
Noisy noisy(const Curve& curve, double sigma) {
  Noisy out;
  Rng rng(3, "denoise");
  for (int i = 0; i < 4000; ++i) {
    out.truth.push_back(curve(i / 200.0));
    out.seen.push_back(out.truth.back() + sigma * rng.normal());
  }
  return out;
}

TEST(SmoothWithinNoise, TakesMostOfTheNoiseOffASlowRamp) {
  const Noisy n = noisy([](double t) { return 0.1 * t; }, 0.01);
  EXPECT_LT(rms(smooth_within_noise(n.seen, 0.01), n.truth, 100, 3900), 0.004);
}

TEST(SmoothWithinNoise, TellsTheNoiseThatIsLeft) {
  const Noisy n = noisy([](double t) { return 0.1 * t; }, 0.01);
  double left = 0.0;
  const std::vector<double> out = smooth_within_noise(n.seen, 0.01, &left);
  EXPECT_NEAR(left, rms(out, n.truth, 0, 4000), 0.15 * left);
  smooth_within_noise(std::vector<double>(10, 1.0), 0.01, &left);  // too short to be smoothed
  EXPECT_EQ(left, 0.01);
}

TEST(SmoothWithinNoise, KeepsAnEdgeWhereItIs) {
  const Noisy n = noisy([](double t) { return t < 10.0 ? 0.0 : 1.0; }, 0.01);
  const std::vector<double> out = smooth_within_noise(n.seen, 0.01);
  EXPECT_LT(out[1999], 0.1);
  EXPECT_GT(out[2000], 0.9);
}

TEST(SmoothWithinNoise, NeitherShiftsNorShrinksASine) {
  const auto sine = [](double t) { return std::sin(2.0 * std::numbers::pi * t); };
  const Noisy n = noisy(sine, 0.01);
  const std::vector<double> out = smooth_within_noise(n.seen, 0.01);
  double in_phase = 0.0, quadrature = 0.0;
  for (int i = 200; i < 3800; ++i) {
    const double t = i / 200.0;
    in_phase += out[static_cast<std::size_t>(i)] * sine(t) / 1800.0;
    quadrature += out[static_cast<std::size_t>(i)] * std::cos(2.0 * std::numbers::pi * t) / 1800.0;
  }
  EXPECT_NEAR(in_phase, 1.0, 0.004);  // less than half the noise of one sample
  EXPECT_NEAR(quadrature, 0.0, 0.002);
}

TEST(SmoothWithinNoise, LeavesSamplesBesideMissingOnesAlone) {
  Noisy n = noisy([](double) { return 1.0; }, 0.01);
  n.seen[2000] = kMissing;
  const std::vector<double> out = smooth_within_noise(n.seen, 0.01);
  EXPECT_TRUE(std::isnan(out[2000]));
  EXPECT_EQ(out[1999], n.seen[1999]);
  EXPECT_TRUE(std::isfinite(out[1990]));
}

TEST(SmoothWithinNoise, DoesNothingWithoutNoise) {
  const Noisy n = noisy([](double t) { return t * t; }, 0.01);
  EXPECT_EQ(smooth_within_noise(n.seen, 0.0), n.seen);
}

// Centre of the least-squares parabola over 2m + 1 samples (Savitzky and Golay), summed from the middle outwards.
double centre(const std::vector<double>& x, std::size_t i, std::size_t m_size, double* own_weight) {
  const double m = static_cast<double>(m_size);
  const auto weight = [&](double k) {
    return 3.0 * (3.0 * m * m + 3.0 * m - 1.0 - 5.0 * k * k) /
           ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
  };
  *own_weight = weight(0.0);
  double sum = *own_weight * x[i];
  for (std::size_t k = 1; k <= m_size; ++k) sum += weight(static_cast<double>(k)) * (x[i - k] + x[i + k]);
  return sum;
}

TEST(SmoothWithinNoise, TakesTheWidestParabolaThatAgreesWithTheNarrowerOnesAtEverySample) {
  constexpr double kSigma = 0.01, kAgree = 1.7;
  const Noisy n = noisy([](double t) { return std::sin(t * t); }, kSigma);  // ever faster: all widths come up
  const std::vector<double> out = smooth_within_noise(n.seen, kSigma);
  for (std::size_t i = 0; i < out.size(); ++i) {
    double low = n.seen[i] - kAgree * kSigma, high = n.seen[i] + kAgree * kSigma, expected = n.seen[i];
    for (const std::size_t m : {2, 4, 8, 16, 32}) {
      if (i < m || i + m >= out.size()) break;
      double own_weight = 0.0;
      const double estimate = centre(n.seen, i, m, &own_weight),
                   spread = kAgree * kSigma * std::sqrt(own_weight);
      low = std::max(low, estimate - spread);
      high = std::min(high, estimate + spread);
      if (low > high) break;
      expected = estimate;
    }
    EXPECT_EQ(out[i], expected) << i;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
