// What a playback of eq. (3)-(5) cannot show: the decay is a state of the film. Every test here fails for a
// rig that computes the loss from time, frequency and amplitude.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "rigs/emulated/emulated_rig.h"
#include "tests/unit/emulated/maxima.h"

namespace forcegate::test {
namespace {

const std::map<std::string, std::string> kPlain{{"session_spread", "off"}};

std::unique_ptr<Stimulus> sine(double f_Hz, double A_N, double m_N, double duration_s = 1200.0) {
  return stimulus("sine", {{"f_Hz", f_Hz}, {"A_N", A_N}, {"m_N", m_N}, {"duration_s", duration_s}});
}

/// Gain N/V of eq. (1) from two slow sweeps after 20 minutes of cycling and a rest.
double gain_after_N_per_V(double cycling_s, double rest_s, const std::string& sensor = "flexiforce") {
  Joined load;
  if (cycling_s > 0.0) load.add(sine(0.5, 1.5, 2.7, cycling_s), cycling_s);
  load.add(stimulus("rest", {{"level_N", 0.2}, {"duration_s", rest_s}}), rest_s);
  load.add(stimulus("ramp", {}), 200.0);
  BenchRun bench{.rig_options = kPlain};
  bench.rig_options["sensor"] = sensor;
  const RigBlock block = bench.play(load);
  double n = 0, u1 = 0, f1 = 0, uu = 0, uf = 0;
  for (std::size_t i = block.size() - 200000; i < block.size(); i += 10) {
    const double u = volts(block.adc[i]), f = static_cast<double>(block.force_ref_N[i]);
    n += 1, u1 += u, f1 += f, uu += u * u, uf += u * f;
  }
  return (uf - u1 * f1 / n) / (uu - u1 * u1 / n);
}

TEST(History, output_recovers_within_about_two_hours_of_rest) {
  std::vector<double> first_swing;
  for (const double rest_s : {300.0, 1200.0, 3600.0, 7200.0}) {
    Joined load;
    load.add(sine(0.5, 1.5, 2.7), 1200.0);
    load.add(stimulus("rest", {{"level_N", 1.2}, {"duration_s", rest_s}}), rest_s);
    load.add(sine(0.5, 1.5, 2.7, 60.0), 60.0);
    BenchRun bench{.rig_options = kPlain};
    const Maxima m = find_maxima(bench.play(load), 0.7);
    // Late enough for the loss to show again, early enough to have lost little anew
    const double again = m.swing_V(1200.0 + rest_s + 8.0, 1200.0 + rest_s + 20.0);
    const double fresh = m.swing_V(8.0, 20.0);
    first_swing.push_back(again / fresh);
    std::printf(" rest %5.0f s: swing %.3f of a fresh film\n", rest_s, again / fresh);
  }
  EXPECT_LT(first_swing[0], 0.75);
  EXPECT_LT(first_swing[1], 0.92);
  EXPECT_GT(first_swing[1], first_swing[0] + 0.1);
  EXPECT_GT(first_swing[2], first_swing[1]);
  EXPECT_GT(first_swing[3], 0.97);
}

TEST(History, rest_in_mid_record_gives_back_a_part_of_the_loss_only) {
  Joined load;
  load.add(sine(0.5, 1.5, 2.7, 600.0), 600.0);
  load.add(stimulus("rest", {{"level_N", 1.2}, {"duration_s", 60.0}}), 60.0);
  load.add(sine(0.5, 1.5, 2.7, 540.0), 540.0);
  BenchRun bench{.rig_options = kPlain};
  const Maxima m = find_maxima(bench.play(load), 0.7);
  const double fresh = m.swing_V(0.0, 4.0), before = m.swing_V(590.0, 600.0), after = m.swing_V(672.0, 690.0);
  const double end = m.swing_V(1190.0, 1200.0);
  std::printf(" swing fresh %.2f V, before rest %.2f V, after 60 s %.2f V, end %.2f V\n", fresh, before,
              after, end);
  EXPECT_GT(after, 1.15 * before);  // the time law goes on falling
  EXPECT_LT(after, 0.6 * fresh);    // a law that starts anew would be back at the full swing
  EXPECT_LT(end, before);
}

TEST(History, ratio_stays_frozen_at_the_amplitude_of_the_beginning) {
  // 1.5 N for 10 min, then 0.8 N around the same minimum; law (5) of 0.8 N would end at r = 0.36, of 1.5 N at
  // 0.20.
  Joined load;
  load.add(sine(0.5, 1.5, 2.7, 600.0), 600.0);
  load.add(sine(0.5, 0.8, 2.0, 1200.0), 1200.0);
  BenchRun bench{.rig_options = kPlain};
  const Maxima m = find_maxima(bench.play(load), 0.5);
  const double ratio = m.swing_V(1780.0, 1800.0) / (1.6 / 0.5);
  std::printf(" end ratio %.3f\n", ratio);
  EXPECT_NEAR(ratio, law_ratio(1.5) / (1.0 + law_ratio(1.5)), 0.03);
}

TEST(History, a_change_of_amplitude_does_not_start_the_decay_anew) {
  Joined load;
  load.add(sine(0.5, 0.8, 2.0, 600.0), 600.0);
  load.add(sine(0.5, 1.5, 2.7, 600.0), 600.0);
  BenchRun bench{.rig_options = kPlain};
  const Maxima m = find_maxima(bench.play(load), 0.5);
  const double ratio = m.swing_V(605.0, 620.0) / 6.0;
  const double q = law_ratio(0.8), decayed = (std::exp(-law_b_per_s(0.5) * 612.0) + q) / (1.0 + q);
  EXPECT_NEAR(ratio, decayed, 0.04);
}

TEST(History, a_jump_of_frequency_raises_the_output_which_then_returns_to_the_undisturbed_curve) {
  BenchRun bench{.rig_options = kPlain};
  const auto jump = stimulus("jump", {{"A_N", 1.5}, {"m_N", 2.7}},
                             {{"f_Hz", {0.5, 2.0, 3.0}}, {"stretch_s", {400.0, 400.0, 400.0}}});
  const Maxima with = find_maxima(bench.play(*jump), 0.7);
  const Maxima without = find_maxima(bench.play(*sine(0.5, 1.5, 2.7)), 0.7);
  const double before = with.swing_V(380.0, 400.0);
  double peak = 0.0;
  for (double t = 401.0; t < 420.0; t += 2.0) peak = std::max(peak, with.swing_V(t, t + 2.0));
  const double second_before = with.swing_V(780.0, 800.0);
  double second_peak = 0.0;
  for (double t = 801.0; t < 820.0; t += 2.0) second_peak = std::max(second_peak, with.swing_V(t, t + 2.0));
  const double lost = with.swing_V(0.0, 4.0) - before;
  std::printf(
      " swing before %.2f V, peak %.2f V (%.0f %% of the lost swing), 100 s later %.2f V, undisturbed %.2f "
      "V; "
      "second jump %.2f -> %.2f V\n",
      before, peak, 100.0 * (peak - before) / lost, with.swing_V(500.0, 520.0), without.swing_V(500.0, 520.0),
      second_before, second_peak);
  EXPECT_GT((peak - before) / lost, 0.1);
  EXPECT_LT((peak - before) / lost, 0.5);
  EXPECT_GT(second_peak, second_before);
  EXPECT_NEAR(with.swing_V(500.0, 520.0), without.swing_V(500.0, 520.0), 0.05);
  EXPECT_NEAR(with.swing_V(1180.0, 1200.0), without.swing_V(1180.0, 1200.0), 0.05);
}

TEST(History, static_gain_is_about_seven_percent_higher_after_cycling_and_back_after_two_hours) {
  const double fresh = gain_after_N_per_V(0.0, 60.0);
  const double after = gain_after_N_per_V(1200.0, 120.0) / fresh - 1.0;
  const double rested = gain_after_N_per_V(1200.0, 7200.0) / fresh - 1.0;
  std::printf(" static gain %.4f N/V; after 20 min %+.1f %%, after 2 h of rest %+.1f %%\n", fresh,
              100.0 * after, 100.0 * rested);
  EXPECT_NEAR(fresh, 0.5, 0.01);
  EXPECT_NEAR(after, 0.07, 0.02);
  EXPECT_NEAR(rested, 0.0, 0.01);
}

TEST(History, a_record_can_begin_on_a_film_that_was_cycled_before) {
  const auto swing = [](double rest_before_s) {
    BenchRun bench{.rig_options = kPlain};
    bench.request.rest_before_s = rest_before_s;
    return find_maxima(bench.play(*sine(0.5, 1.5, 2.7, 60.0)), 0.7).swing_V(8.0, 20.0);
  };
  EXPECT_LT(swing(300.0), 0.8 * swing(1e9));
  EXPECT_GT(swing(7200.0), 0.97 * swing(1e9));
}

TEST(History, a_load_at_rest_drifts_by_less_than_six_percent_in_20_minutes) {
  double largest = 0.0;
  for (int seed = 1; seed <= 20; ++seed) {
    BenchRun bench;
    bench.request.specimen = "seed:" + std::to_string(seed);
    const RigBlock block = bench.play(*stimulus("rest", {{"level_N", 3.0}}));
    const auto mean = [&](std::size_t at) {
      double sum = 0.0;
      for (std::size_t i = at; i < at + 1000; ++i) sum += volts(block.adc[i]);
      return sum / 1000.0;
    };
    const double drift = mean(block.size() - 1000) / mean(0) - 1.0;
    EXPECT_GT(drift, 0.0);
    largest = std::max(largest, drift);
  }
  std::printf(" largest drift of 20 specimens %.1f %%\n", 100.0 * largest);
  EXPECT_LT(largest, 0.06);
  EXPECT_GT(largest, 0.01);
}

TEST(History, quasi_static_loading_loses_nothing) {
  BenchRun bench{.rig_options = kPlain};
  emulated::EmulatedRig rig({.session_spread = false});
  bench.play(rig, *stimulus("ramp", {{"cycles", 6.0}}));
  EXPECT_LT(rig.film().memory().lost_share(), 0.01);
}

}  // namespace
}  // namespace forcegate::test
