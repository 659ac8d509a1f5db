#include "hil/trace/extrema.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Wave {
  std::vector<double> t, guide;
  std::vector<std::vector<double>> followers;
};

template <class Guide, class... Follower>
Wave make(double rate_Hz, double duration_s, Guide guide, Follower... follower) {
  Wave w;
  w.followers.resize(sizeof...(follower));
  const int n = static_cast<int>(std::lround(duration_s * rate_Hz)) + 1;
  for (int i = 0; i < n; ++i) {
    const double t = i / rate_Hz;
    w.t.push_back(t);
    w.guide.push_back(guide(t));
    std::size_t k = 0;
    (w.followers[k++].push_back(follower(t)), ...);
  }
  return w;
}

std::vector<PairedExtremum> pair(const Wave& w, ExtremaPairer::Options options) {
  options.followers = w.followers.size();
  ExtremaPairer pairer(options);
  std::vector<double> row(w.followers.size());
  for (std::size_t i = 0; i < w.t.size(); ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = w.followers[k][i];
    pairer.push(w.t[i], w.guide[i], row.data());
  }
  pairer.finish();
  return pairer.pairs();
}

TEST(TurningPoints, FindEveryCrestAndTroughOfASine) {
  const auto w = make(1000, 10.0, [](double t) { return 2.0 + std::sin(2 * std::numbers::pi * 0.5 * t); });
  const auto found = turning_points(w.t, w.guide, 0.1);
  ASSERT_EQ(found.size(), 10u);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].turn, i % 2 == 0 ? Turn::maximum : Turn::minimum);
    EXPECT_NEAR(found[i].t_s, 0.5 + static_cast<double>(i), 1e-3);
    EXPECT_NEAR(found[i].value, i % 2 == 0 ? 3.0 : 1.0, 1e-6);
  }
}

TEST(TurningPoints, AConstantHasNone) {
  EXPECT_TRUE(turning_points(std::vector<double>{0, 1, 2, 3}, std::vector<double>{1, 1, 1, 1}, 0.0).empty());
}

TEST(TurningPoints, TheEndsOfARecordAreNone) {
  EXPECT_TRUE(turning_points(std::vector<double>{0, 1, 2, 3}, std::vector<double>{0, 1, 2, 3}, 0.5).empty());
  EXPECT_EQ(turning_points(std::vector<double>{0, 1, 2}, std::vector<double>{0, 1, 0}, 0.5).size(), 1u);
  EXPECT_EQ(turning_points(std::vector<double>{0, 1, 2}, std::vector<double>{1, 0, 1}, 0.5).size(), 1u);
}

TEST(TurningPoints, NoiseBelowTheProminenceAddsNone) {
  Rng rng(3, "noise");
  auto w = make(1000, 20.0, [](double t) { return std::sin(2 * std::numbers::pi * t); });
  for (double& v : w.guide) v += rng.uniform(-0.09, 0.09);
  EXPECT_EQ(turning_points(w.t, w.guide, 0.2).size(), 40u);
}

TEST(TurningPoints, MissingSamplesAreSkipped) {
  auto w = make(1000, 10.0, [](double t) { return std::sin(2 * std::numbers::pi * t); });
  for (std::size_t i = 0; i < w.guide.size(); i += 7) w.guide[i] = i % 2 == 0 ? kNan : HUGE_VAL;
  EXPECT_EQ(turning_points(w.t, w.guide, 0.1).size(), 20u);
}

TEST(TurningPoints, APlateauTurnsAtItsMiddle) {
  const auto found = turning_points(std::vector<double>{0, 1, 2, 3, 4, 5}, std::vector<double>{0, 1, 1, 1, 0, 0}, 0.5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].t_s, 2.0);
}

TEST(TurningPoints, AlternateAndExceedTheProminenceWhateverTheSignal) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Rng rng(seed, "walk");
    std::vector<double> t, x;
    double level = 0.0;
    for (int i = 0; i < 2000; ++i) {
      level += rng.normal(0.0, 0.3);
      t.push_back(i);
      x.push_back(rng.uniform() < 0.05 ? kNan : level);
    }
    const auto found = turning_points(t, x, 1.0);
    for (std::size_t i = 1; i < found.size(); ++i) {
      EXPECT_NE(found[i].turn, found[i - 1].turn);
      EXPECT_GT(std::fabs(found[i].value - found[i - 1].value), 1.0);
      EXPECT_GT(found[i].t_s, found[i - 1].t_s);
    }
  }
}

TEST(ExtremaPairer, ReadsEachFollowersOwnExtremum) {
  const auto w = make(
      1000, 20.0, [](double t) { return 2.15 + 1.05 * std::sin(2 * std::numbers::pi * 0.5 * t); },
      [](double t) { return 2.0 + 0.9 * std::sin(2 * std::numbers::pi * 0.5 * (t - 0.1)); },
      [](double t) { return -std::sin(2 * std::numbers::pi * 0.5 * t); });
  const auto pairs = pair(w, {.prominence = 0.2});
  ASSERT_GE(pairs.size(), 19u);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool maximum = pairs[i].turn == Turn::maximum;
    EXPECT_NEAR(pairs[i].value[0], maximum ? 2.9 : 1.1, 1e-5);
    EXPECT_NEAR(pairs[i].at_s[0] - pairs[i].t_s, 0.1, 2e-3);
    EXPECT_NEAR(pairs[i].guide, maximum ? 3.2 : 1.1, 1e-5);
  }
}

TEST(ExtremaPairer, AverageRemovesTheBiasOfNoise) {
  Rng rng(11, "noise");
  const auto w = make(
      1000, 200.0, [](double t) { return 2.0 + std::sin(2 * std::numbers::pi * 0.5 * t); },
      [&](double t) { return 2.0 + std::sin(2 * std::numbers::pi * 0.5 * t) + rng.normal(0.0, 0.05); });
  double raw = 0.0, averaged = 0.0;
  int n = 0;
  const auto plain = pair(w, {.prominence = 0.2}), smooth = pair(w, {.prominence = 0.2, .half_width = 20});
  ASSERT_EQ(plain.size(), smooth.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain[i].turn != Turn::maximum) continue;
    raw += plain[i].value[0] - 3.0;
    averaged += smooth[i].value[0] - 3.0;
    ++n;
  }
  EXPECT_GT(raw / n, 0.08);  // more than 1.6 standard deviations too high
  EXPECT_LT(std::fabs(averaged / n), 0.016);
}

TEST(ExtremaPairer, GivesEqualExtremaForIdenticalChannelsAtAnyFrequency) {
  const auto chirp = [](double t) { return 2.5 + std::sin(2 * std::numbers::pi * (0.05 * t + 0.5 * 0.0125 * t * t)); };
  const auto w = make(1000, 240.0, chirp, chirp);  // 0.05 to 3 Hz
  const auto pairs = pair(w, {.prominence = 0.2});
  EXPECT_GT(pairs.size(), 700u);
  for (const auto& p : pairs) EXPECT_EQ(p.value[0], p.guide);
}

TEST(ExtremaPairer, FindsTheCyclesAfterALongRest) {
  const auto profile = [](double t) {
    return t < 1000 ? 1.0 : 1.0 + 0.5 * (1 - std::cos(2 * std::numbers::pi * (t - 1000)));
  };
  const auto w = make(200, 1020.0, profile, profile);
  const auto pairs = pair(w, {.prominence = 0.2});
  ASSERT_GE(pairs.size(), 38u);
  for (const auto& p : pairs) EXPECT_EQ(p.value[0], p.guide);
}

TEST(ExtremaPairer, AShiftedWindowFollowsALaggingChannel) {
  // A follower later by 0.7 of a half-cycle: the unshifted window cuts its crest off.
  const auto sine = [](double t) { return std::sin(2 * std::numbers::pi * 0.5 * t); };
  const auto w = make(1000, 30.0, sine, [&](double t) { return t < 0.7 ? 0.0 : sine(t - 0.7); });
  const auto shifted = pair(w, {.prominence = 0.2, .lag_s = 0.7});
  ASSERT_GE(shifted.size(), 27u);
  for (const auto& p : shifted) EXPECT_NEAR(p.value[0], p.guide, 1e-5);
  const auto unshifted = pair(w, {.prominence = 0.2});
  EXPECT_LT(unshifted[4].value[0], 0.96);
}

TEST(ExtremaPairer, CoversTheWholePlateauOfABinarySequence) {
  Rng rng(5, "prbs");
  std::vector<int> bits;
  for (int i = 0; i < 200; ++i) bits.push_back(rng.uniform() < 0.5);
  const auto level = [&](double t) { return bits[static_cast<std::size_t>(t / 0.5) % 200] ? 4.0 : 1.0; };
  double slow = 1.0, last = 0.0;
  const auto w = make(500, 90.0, level, [&](double t) {
    slow += (level(t) - slow) * (1 - std::exp(-(t - last) / 0.1));
    last = t;
    return slow;
  });
  const auto pairs = pair(w, {.prominence = 0.5});
  EXPECT_GT(pairs.size(), 40u);
  int reached = 0;
  for (const auto& p : pairs) reached += p.turn == Turn::maximum && p.value[0] > 3.6;
  EXPECT_GT(reached, 15);
}

TEST(ExtremaPairer, AFollowerWithoutSamplesIsNotANumber) {
  const auto sine = [](double t) { return std::sin(2 * std::numbers::pi * t); };
  for (const int half_width : {0, 5}) {
    const auto w = make(
        200, 10.0, sine, [](double) { return kNan; },
        [&](double t) { return std::fmod(t, 0.05) < 0.01 ? kNan : sine(t); });
    const auto pairs = pair(w, {.prominence = 0.2, .half_width = half_width});
    ASSERT_GE(pairs.size(), 18u);
    for (const auto& p : pairs) {
      EXPECT_TRUE(std::isnan(p.value[0]));
      EXPECT_NEAR(std::fabs(p.value[1]), 1.0, 0.02);
    }
  }
}

TEST(ExtremaPairer, ColumnsAndRowsGiveTheSame) {
  const auto sine = [](double t) { return static_cast<float>(2 + std::sin(2 * std::numbers::pi * t)); };
  const auto w = make(1000, 10.0, sine, [&](double t) { return static_cast<float>(0.9 * sine(t)); });
  const std::vector<float> guide(w.guide.begin(), w.guide.end());
  const std::vector<float> follower(w.followers[0].begin(), w.followers[0].end());
  ExtremaPairer columns({.prominence = 0.2, .half_width = 3});
  const float* pointer = nullptr;
  for (std::size_t at = 0; at < w.t.size(); at += 333) {
    const std::size_t n = std::min<std::size_t>(333, w.t.size() - at);
    pointer = follower.data() + at;
    columns.push(std::span(w.t).subspan(at, n), std::span(guide).subspan(at, n), std::span(&pointer, 1));
  }
  columns.finish();
  const auto rows = pair(w, {.prominence = 0.2, .half_width = 3});
  ASSERT_EQ(columns.pairs().size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(columns.pairs()[i].t_s, rows[i].t_s);
    EXPECT_EQ(columns.pairs()[i].value, rows[i].value);
    EXPECT_EQ(columns.pairs()[i].at_s, rows[i].at_s);
  }
}

TEST(ExtremaPairer, AgreesWithASearchThroughTheWholeRecord) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, "property");
    const double f = rng.uniform(0.05, 5.0), phase = rng.uniform(0, 6.28),
                 rate = rng.uniform(20, 500) * (1 + f);
    const double lag = rng.uniform(-0.2, 0.2) / f;
    auto w = make(
        rate, 12.0 / f, [&](double t) { return std::sin(2 * std::numbers::pi * f * t + phase); },
        [&](double t) {
          return std::sin(2 * std::numbers::pi * f * t + phase) * std::exp(-0.1 * f * t) + rng.normal(0, 0.02);
        });
    const auto pairs = pair(w, {.prominence = 0.3, .lag_s = lag});
    const auto turns = turning_points(w.t, w.guide, 0.3);
    ASSERT_GE(pairs.size() + 1, turns.size());
    for (std::size_t k = 1; k + 1 < pairs.size(); ++k) {
      const double from = 0.5 * (turns[k - 1].t_s + turns[k].t_s) + lag,
                   to = 0.5 * (turns[k].t_s + turns[k + 1].t_s) + lag;
      const bool maximum = turns[k].turn == Turn::maximum;
      double best = maximum ? -1e9 : 1e9;
      for (std::size_t i = 0; i < w.t.size(); ++i) {
        if (w.t[i] < from || w.t[i] > to) continue;
        best = maximum ? std::max(best, w.followers[0][i]) : std::min(best, w.followers[0][i]);
      }
      EXPECT_NEAR(pairs[k].value[0], best, 1e-3) << "seed " << seed << " extremum " << k;
    }
  }
}

TEST(MeanRelativeError, IsThatOfEquationNine) {
  const std::vector<double> actual{1.1, 1.8, 3.0, kNan, 5.0}, expected{1.0, 2.0, 3.0, 1.0, 0.01};
  const auto e = mean_relative_error(actual, expected, 0.5);
  EXPECT_EQ(e.n, 3u);
  EXPECT_EQ(e.left_out, 1u);
  EXPECT_EQ(e.not_finite, 1u);
  EXPECT_NEAR(e.mean, 0.2 / 3.0, 1e-12);
  EXPECT_NEAR(e.largest, 0.1, 1e-12);
  EXPECT_NEAR(e.standard_error, std::sqrt((2 * 0.1 * 0.1 - 3 * e.mean * e.mean) / 2.0 / 3.0), 1e-12);
  EXPECT_NEAR(e.mean_absolute, (0.1 + 0.2 + 0.0 + 4.99) / 4.0, 1e-12);
  const double squares = 0.1 * 0.1 + 0.2 * 0.2 + 4.99 * 4.99 - 4 * e.mean_absolute * e.mean_absolute;
  EXPECT_NEAR(e.standard_error_absolute, std::sqrt(squares / 3.0 / 4.0), 1e-12);
}

TEST(MeanRelativeError, OfNothingIsNotZero) {
  EXPECT_TRUE(std::isnan(mean_relative_error({}, {}, 0.1).mean));
  const std::vector<double> a{1.0}, e{0.0};
  EXPECT_TRUE(std::isnan(mean_relative_error(a, e, 0.0).mean));
}

}  // namespace
}  // namespace forcegate
