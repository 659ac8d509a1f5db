#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

TEST(SingleRecording, KeepsItsHistoryFromBlockToBlock) {
  // a slow pole: every block begins with what the one before it left behind
  const auto slow = [](double t) {
    return 3.0 + std::sin(0.011 * t) + 0.8 * std::sin(0.037 * t + 1.0) + 0.5 * std::sin(0.083 * t + 2.0);
  };
  const Diagnosis d = answer(recording(
      0.25, 1000, slow,
      [](const std::vector<double>& t, const std::vector<double>& x) {
        std::vector<double> y(x.size(), 0.0);
        double s = 1.0;
        for (std::size_t i = 1; i < x.size(); ++i) {
          s += (x[i] - s) * -std::expm1(-(t[i] - t[i - 1]) / 45.0);
          y[i] = 1.3 * s;
        }
        return y;
      },
      0.02));
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, "lag");
  EXPECT_GE(d.findings.front().probability, 0.5);
  EXPECT_LT(d.error_after, 0.3 * d.error_before);
}

// Waves of the whole recording nearly cancel over a part of it, and their strengths there say nothing of a size.
TEST(SingleRecording, AZeroThatWandersIsToldByWhatItDoes) {
  constexpr double kMoves_V = 0.05;
  const Diagnosis d = answer(recording(
      50.0, 7500, [](double t) { return 2.2 + 1.8 * std::sin(0.25 * t); },
      [](const std::vector<double>& t, const std::vector<double>& x) {
        std::vector<double> y;
        for (std::size_t i = 0; i < x.size(); ++i) y.push_back(1.8 * x[i] + 0.1 + kMoves_V * (std::sin(0.12 * t[i]) + std::exp(-t[i] / 9.0)));
        return y;
      },
      0.002));
  EXPECT_LT(d.repeatability.wander_V, 2.0 * kMoves_V);
}

TEST(SingleRecording, StrokesOfOneSpeedEachWayDoNotPartFrictionFromDamping) {
  // out at 6, back at 13: a loop that goes with the direction and one that goes with the speed are the same here
  const auto strokes = [](double t) {
    constexpr double kOut_s = 6.0, kBack_s = 3.0;
    const double x = std::fmod(t, kOut_s + kBack_s);
    return x < kOut_s ? 6.5 * x : 39.0 - 13.0 * (x - kOut_s);
  };
  const Diagnosis d = answer(recording(
      100.0, 9000, strokes,
      [](const std::vector<double>&, const std::vector<double>& x) {
        std::vector<double> y;
        double v = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
          const double now = i > 0 ? 100.0 * (x[i] - x[i - 1]) : 6.5;
          v += 0.2 * (now - v);
          y.push_back(340.0 + 0.02 * x[i] + 0.6 * v + 4.0 * std::tanh(v));
        }
        return y;
      },
      0.3));
  for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << f.effect;
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
  ASSERT_FALSE(d.not_separable.empty());
  EXPECT_GE(d.not_separable.front().size(), 2u);
}

TEST(SingleRecording, TheSwingOfACycledSensorMayDecayAsItsModelSays) {
  // Lebosse 2011, eq. (3), with b and c/a of a specimen of its own: the paper's experiment as one CSV of t, F, U
  for (const double b_per_s : {0.0052, 0.0095}) {
    const auto sine = [](double t) { return 2.15 + 1.05 * std::sin(3.14159265358979 * t); };
    const Diagnosis d = answer(recording(
        50.0, 40000, sine,
        [&](const std::vector<double>& t, const std::vector<double>& F) {
          constexpr double kKept = 0.27, kLowest_N = 1.1;
          std::vector<double> U;
          for (std::size_t i = 0; i < F.size(); ++i)
            U.push_back((kLowest_N +
                         (kKept + (1.0 - kKept) * std::exp(-b_per_s * t[i])) * (F[i] - kLowest_N) - 0.12) /
                        0.53);
          return U;
        },
        0.003));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << b_per_s;
    for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << f.effect << " at b = " << b_per_s;
    EXPECT_LT(d.error_before, 0.006) << "the law itself must follow the record";
  }
}

TEST(SingleRecording, AReferenceThatIsLateIsNoCreep) {
  // the output leads F_ref by a millisecond: in one sine a slow growth of the right sign would fit nearly as well
  const Diagnosis d = answer(recording(
      100.0, 20000, [](double t) { return 2.1 + 1.4 * std::sin(3.14159265358979 * t); },
      [](const std::vector<double>& t, const std::vector<double>&) {
        std::vector<double> U;
        for (const double s : t) U.push_back(2.0 * (2.1 + 1.4 * std::sin(3.14159265358979 * (s + 0.001))) + 0.2);
        return U;
      },
      0.002));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << (d.findings.empty() ? "" : d.findings.front().effect);
}

// A force-sensing resistor in a divider of 5 V: bent by its power law, and by a loop of plays inside.
Campaign divider(double play_share) {
  const auto sweep = [](double t) { return 5.2 - 4.8 * std::cos(0.4 * t) * (0.35 + 0.65 * std::abs(std::cos(0.021 * t))); };
  return recording(
      50.0, 15000, sweep,
      [play_share](const std::vector<double>&, const std::vector<double>& x) {
        std::vector<double> y, play(3, x[0]);
        for (const double F : x) {
          double felt = (1.0 - play_share) * F;
          for (std::size_t j = 0; j < play.size(); ++j) {
            const double r = 0.4 * static_cast<double>(j + 1);
            play[j] = std::clamp(play[j], F - r, F + r);
            felt += play_share * play[j] / 3.0;
          }
          y.push_back(5.0 / (1.0 + std::pow(4.0 / std::max(felt, 0.01), 1.1)));
        }
        return y;
      },
      0.003);
}

std::vector<std::string> claims(const Diagnosis& d) {
  std::vector<std::string> out;
  for (const Finding& f : d.findings)
    if (f.probability >= 0.5) out.push_back(f.effect);
  std::sort(out.begin(), out.end());
  return out;
}

TEST(SingleRecording, TheCurveOfADividerIsNoThresholdOfItsContacts) {
  EXPECT_EQ(claims(answer(divider(0.0))), std::vector<std::string>{"static_nonlinearity"});
}

TEST(SingleRecording, ALoopThatTakesAllThatTheCurveLeftIsASecondEffect) {
  EXPECT_EQ(claims(answer(divider(0.25))), (std::vector<std::string>{"hysteresis", "static_nonlinearity"}));
}

// Growth with three time constants under a hold of ten minutes.
std::vector<double> creeping(const std::vector<double>& t, const std::vector<double>& F) {
  std::vector<double> U(F.size());
  double state[3] = {F[0], F[0], F[0]};
  for (std::size_t i = 0; i < F.size(); ++i) {
    double grown = 0.0;
    for (int k = 0; k < 3; ++k) {
      if (i > 0) state[k] += (F[i] - state[k]) * -std::expm1(-(t[i] - t[i - 1]) / std::pow(10.0, k));
      grown += 0.03 * state[k];
    }
    U[i] = 2.0 * (F[i] + grown) + 0.2;
  }
  return U;
}

TEST(SingleRecording, WhatAHoldShowsOfCreepIsNotTakenForAZeroThatWanders) {
  const auto load = [](double at_s) { return [at_s](double t) { return t < at_s ? 0.2 : 3.0; }; };
  const Diagnosis early = answer(recording(100.0, 60000, load(5.0), creeping, 0.003));
  EXPECT_EQ(claims(early), std::vector<std::string>{"creep"});
  EXPECT_EQ(early.judged_by, JudgedBy::whole) << "the load that is put on belongs to what is judged";
}

// Growth without a time constant: a sum over a decade of relaxations that no pole of the library's has.
std::vector<double> stretched(const std::vector<double>& t, const std::vector<double>& F) {
  std::vector<double> U(F.size());
  std::vector<double> state(25, F[0]);
  for (std::size_t i = 0; i < F.size(); ++i) {
    double grown = 0.0;
    for (std::size_t k = 0; k < state.size(); ++k) {
      const double tau_s = 0.7 * std::pow(10.0, 0.11 * static_cast<double>(k));
      if (i > 0) state[k] += (F[i] - state[k]) * -std::expm1(-(t[i] - t[i - 1]) / tau_s);
      grown += 0.004 * state[k];
    }
    U[i] = 2.0 * (F[i] + grown) + 0.2;
  }
  return U;
}

TEST(SingleRecording, OneStepInOnePartShowsCreepOfTheWhole) {
  // no part foretells what its only step does: the whole is described to its noise nevertheless
  for (const double at_s : {120.0, 346.0}) {
    const Diagnosis d = answer(recording(100.0, 60000, [at_s](double t) { return t < at_s ? 0.2 : 3.0; }, stretched, 0.003));
    ASSERT_EQ(claims(d), std::vector<std::string>{"creep"}) << at_s;
    EXPECT_EQ(d.judged_by, JudgedBy::whole);
    EXPECT_LT(d.error_after, 0.1 * d.error_before);
    EXPECT_NE(d.findings.front().evidence.find("the whole recording"), std::string::npos);
  }
}

TEST(SingleRecording, AZeroThatMovesBesideAStepIsNotDescribedByIt) {
  // a course of the zero of its own, which begins long before the step
  const auto drifting = [](const std::vector<double>& t, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * F[i] + 0.2 + 0.15 * std::sin(0.013 * t[i] + 0.4));
    return U;
  };
  EXPECT_EQ(claims(answer(recording(100.0, 60000, [](double t) { return t < 346.0 ? 0.2 : 3.0; }, drifting, 0.003))), std::vector<std::string>{});
}

TEST(SingleRecording, CyclesMayBeginAfterOtherMovements) {
  // other movements, then cycles whose swing decays from its own start on (Lebosse 2011, eq. 3)
  constexpr double kBegin_s = 150.0, kLowest_N = 1.1, kSwing_N = 2.1, kKept = 0.3, kRate_per_s = 0.009;
  using Load = std::function<double(double)>;
  const Load steps_and_triangle = [](double t) {
    return t < 60.0 ? 0.4 + 0.9 * std::fmod(std::floor(t / 9.0) * 1.7, 3.1) : t < 130.0 ? 3.4 - 0.09 * std::abs(t - 95.0) : kLowest_N;
  };
  const Load holds_of_the_same_height = [](double t) {
    return t < 60.0 ? 0.3 + 0.04 * t : kLowest_N + (std::fmod(t - 60.0, 30.0) < 15.0 ? 0.0 : kSwing_N);
  };
  const auto sensor = [](const std::vector<double>& t, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double D = t[i] < kBegin_s ? 1.0 : kKept + (1.0 - kKept) * std::exp(-kRate_per_s * (t[i] - kBegin_s));
      U.push_back((kLowest_N + D * (F[i] - kLowest_N) - 0.12) / 0.53);
    }
    return U;
  };
  const Load sine = [](double since_s) { return 0.5 - 0.5 * std::cos(3.14159265358979 * since_s); };
  const Load fast_rise = [](double since_s) {
    const double phase = std::fmod(0.5 * since_s, 1.0);
    return phase < 0.2 ? 5.0 * phase : 1.25 * (1.0 - phase);
  };
  for (const auto& [before, cycle] : {std::pair{steps_and_triangle, sine}, std::pair{holds_of_the_same_height, sine}, std::pair{steps_and_triangle, fast_rise}}) {
    const auto load = [&](double t) { return t < kBegin_s ? before(t) : kLowest_N + kSwing_N * cycle(t - kBegin_s); };
    const Diagnosis d = answer(recording(50.0, 25000, load, sensor, 0.004));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << (d.findings.empty() ? "" : d.findings.front().effect);
    EXPECT_LT(d.error_after, 0.008);
  }
}

TEST(SingleRecording, ItsRawSamplesSpeakForThemselves) {
  const auto humming = [](const std::vector<double>& t, const std::vector<double>& F) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * F[i] + 0.2 + 0.1 * std::sin(314.159265358979 * t[i]));
    return U;
  };
  EXPECT_EQ(claims(answer(recording(500.0, 30000, [](double t) { return 2.0 + std::sin(0.7 * t); }, humming, 0.003))), std::vector<std::string>{"hum"});
}

TEST(SingleRecording, AStraightSensorUnderAHoldMissesNothing) {
  const auto straight = [](const std::vector<double>&, const std::vector<double>& F) {
    std::vector<double> U;
    for (const double f : F) U.push_back(2.0 * f + 0.2);
    return U;
  };
  EXPECT_EQ(answer(recording(100.0, 60000, [](double t) { return t < 5.0 ? 0.2 : 3.0; }, straight, 0.003)).verdict, DiagnosisVerdict::none);
}

TEST(SingleRecording, AZeroThatWandersIsNoCreep) {
  for (const int seed : {1, 2, 3}) {
    const auto wandering = [&](const std::vector<double>& t, const std::vector<double>& F) {
      Rng rng(static_cast<std::uint64_t>(seed), "wander");
      constexpr double kSize_V = 0.02, kTime_s = 400.0;
      std::vector<double> U;
      double zero = kSize_V * rng.normal();
      for (std::size_t i = 0; i < F.size(); ++i) {
        const double kept = i > 0 ? std::exp(-(t[i] - t[i - 1]) / kTime_s) : 1.0;
        zero = kept * zero + kSize_V * std::sqrt(1.0 - kept * kept) * rng.normal();
        U.push_back(2.0 * F[i] + 0.2 + zero);
      }
      return U;
    };
    const auto stairs = [](double t) { return 0.3 + 0.6 * std::min(std::floor(t / 60.0), std::floor((600.0 - t) / 60.0)); };
    const Diagnosis d = answer(recording(100.0, 60000, stairs, wandering, 0.003));
    for (const Finding& f : d.findings) EXPECT_LT(f.probability, 0.5) << seed << ' ' << f.effect;
  }
}

// What the recorder lost: the sensor was loaded meanwhile.
Campaign without_rows(Campaign c, double from_s, double to_s) {
  Record& r = c.records.front();
  std::vector<double>& t = r.trace.time_bases.front().t_s;
  const std::vector<double> all = t;
  const auto keep = [&](std::vector<double>& values) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i] < from_s || all[i] >= to_s) values[n++] = values[i];
    values.resize(n);
  };
  keep(t);
  for (Channel& channel : r.trace.channels) keep(channel.value);
  return c;
}

TEST(SingleRecording, WhatHappenedInAGapIsNoErrorOfTheModel) {
  // a loop of plays; during each gap the load stood high, which nobody saw
  const auto load = [](double t) {
    const bool unseen = (t > 120.0 && t < 150.0) || (t > 310.0 && t < 340.0);
    return unseen ? 9.0 : 2.0 - 1.2 * std::cos(0.3 * t) + 0.7 * std::sin(0.11 * t);
  };
  const auto looping = [](const std::vector<double>&, const std::vector<double>& F) {
    std::vector<double> U, play(4, F[0]);
    for (const double f : F) {
      double felt = 0.8 * f;
      for (std::size_t j = 0; j < play.size(); ++j) {
        const double r = 0.2 * static_cast<double>(j + 1);
        play[j] = std::clamp(play[j], f - r, f + r);
        felt += 0.05 * play[j];
      }
      U.push_back(2.0 * felt + 0.2);
    }
    return U;
  };
  const Diagnosis d = answer(without_rows(without_rows(recording(50.0, 30000, load, looping, 0.003), 120.0, 150.0), 310.0, 340.0));
  EXPECT_EQ(claims(d), std::vector<std::string>{"hysteresis"});
  EXPECT_LT(d.error_after, 0.006);
  EXPECT_TRUE(std::ranges::any_of(d.notes, [](const std::string& n) { return n.find("rows after a gap (the longest 30") != std::string::npos; }));
}

std::string refusal(Campaign campaign) {
  const auto out = diagnose_campaign(std::move(campaign), {});
  return out ? "accepted" : out.error().to_text();
}

TEST(SingleRecording, ADeadOutputAndAFewRowsAreRefused) {
  const auto dead = [](const std::vector<double>&, const std::vector<double>& F) { return std::vector<double>(F.size(), 2.5); };
  const auto slope = [](double t) { return 1.0 + 0.5 * std::sin(t); };
  EXPECT_NE(refusal(recording(100.0, 6000, slope, dead, 0.0)).find("never moves"), std::string::npos);
  EXPECT_NE(refusal(recording(100.0, 60, slope, creeping, 0.003)).find("too short"), std::string::npos);
}

double slow_waves(double t) { return 2.0 + 1.2 * std::sin(0.4 * t) + 0.6 * std::sin(1.3 * t); }
std::vector<double> straight(const std::vector<double>&, const std::vector<double>& x) {
  std::vector<double> y;
  for (const double v : x) y.push_back(2.0 * v + 0.1);
  return y;
}

TEST(SingleRecording, MayGoOnAtAnotherRate) {
  Campaign c = recording(100.0, 20000, slow_waves, straight, 0.002);
  Trace& trace = c.records.front().trace;
  std::vector<std::size_t> kept;  // 25 Hz in the second half
  for (std::size_t i = 0; i < 20000; ++i)
    if (i < 10000 || i % 4 == 0) kept.push_back(i);
  const auto keep = [&](std::vector<double>& x) {
    std::vector<double> out;
    for (const std::size_t i : kept) out.push_back(x[i]);
    x = std::move(out);
  };
  keep(trace.time_bases.front().t_s);
  for (Channel& channel : trace.channels) keep(channel.value);
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none);
  ASSERT_EQ(d.records.size(), 5u);
  EXPECT_LT(d.error_before, 0.004);
}

TEST(SingleRecording, MayMissItsOutputForAThirdOfItsTime) {
  Campaign c = recording(100.0, 20000, slow_waves, straight, 0.002);
  for (std::size_t i = 8000; i < 14600; ++i) c.records.front().trace.find("U")->value[i] = kMissing;
  const Diagnosis d = answer(std::move(c));
  ASSERT_EQ(d.records.size(), 5u) << "each block has rows to be judged by";
  EXPECT_LT(d.error_before, 0.004);
}

}  // namespace
}  // namespace forcegate::diagnose
