#include "rigs/emulated/population.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <set>

#include "tests/unit/emulated/maxima.h"

namespace forcegate::test {
namespace {

using namespace emulated;

double deviation(const std::vector<double>& v) {
  double sum = 0, squares = 0;
  for (const double x : v) sum += x;
  const double mean = sum / static_cast<double>(v.size());
  for (const double x : v) squares += (x - mean) * (x - mean);
  return std::sqrt(squares / static_cast<double>(v.size())) / std::abs(mean);
}

// docs/paper.md says so of the thirty specimens of the study.
TEST(Population, its_first_thirty_specimens_spread_less_in_b_than_a_large_draw) {
  std::vector<double> b;
  for (int n = 1; n <= 300; ++n)
    b.push_back(value_or_abort(find_specimen("seed:" + std::to_string(n))).b_scale);
  EXPECT_NEAR(deviation({b.begin(), b.begin() + 30}), 0.164, 0.004);
  EXPECT_NEAR(deviation(b), 0.224, 0.002);
}

TEST(Population, has_the_spreads_that_the_paper_states) {
  std::vector<double> b, q, gain, offset, fsr_gain, fsr_offset;
  for (int n = 1; n <= 2000; ++n) {
    const Specimen s = value_or_abort(find_specimen("seed:" + std::to_string(n)));
    b.push_back(s.b_scale);
    q.push_back(s.q_scale);
    const FilmParameters film = draw_session(SensorType::flexiforce, s, 1, 0);
    gain.push_back(film.gain_N_per_V);
    offset.push_back(film.offset_N);
    const FilmParameters fsr = draw_session(SensorType::fsr, s, 1, 0);
    fsr_gain.push_back(fsr.gain_N_per_V);
    fsr_offset.push_back(fsr.offset_N);
  }
  // A normal cut at two standard deviations keeps 0.88 of its spread.
  EXPECT_NEAR(deviation(b), 0.25 * 0.88, 0.012);
  EXPECT_NEAR(deviation(q), 0.14 * 0.88, 0.008);
  EXPECT_NEAR(deviation(gain), 0.09 * 0.88, 0.005);
  EXPECT_NEAR(deviation(offset), 0.22 * 0.88, 0.012);
  EXPECT_NEAR(deviation(fsr_gain), 0.10 * 0.88, 0.006);
  EXPECT_NEAR(deviation(fsr_offset), 0.45 * 0.88, 0.025);
}

TEST(Population, panel_holds_nine_different_specimens_centred_on_the_nominal_one) {
  ASSERT_GE(panel_names().size(), 9U);
  std::set<double> rates;
  double b = 0, q = 0, product = 0;
  for (const std::string& name : panel_names()) {
    const Specimen s = value_or_abort(find_specimen(name));
    rates.insert(s.b_scale);
    b += s.b_scale / 9.0;
    q += s.q_scale / 9.0;
    product += (s.b_scale - 1.0) / 0.25 * (s.q_scale - 1.0) / 0.14 / 9.0;
  }
  EXPECT_EQ(rates.size(), panel_names().size());
  EXPECT_NEAR(b, 1.0, 0.01);
  EXPECT_NEAR(q, 1.0, 0.01);
  EXPECT_LT(std::abs(product), 0.25);  // b and q are not correlated
}

TEST(Population, gain_and_offset_stay_within_a_session_and_change_between_sessions) {
  const Specimen s = value_or_abort(find_specimen("q25"));
  const auto first = draw_session(SensorType::flexiforce, s, 4, 1),
             again = draw_session(SensorType::flexiforce, s, 4, 1);
  const auto other = draw_session(SensorType::flexiforce, s, 4, 2);
  EXPECT_EQ(first.gain_N_per_V, again.gain_N_per_V);
  EXPECT_NE(first.gain_N_per_V, other.gain_N_per_V);
  EXPECT_NE(first.offset_N, other.offset_N);
}

TEST(Population, normal_quantile_is_that_of_tables) {
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-9);
  EXPECT_NEAR(normal_quantile(0.95), 1.6448536269514722, 1e-7);
  EXPECT_NEAR(normal_quantile(0.05), -1.6448536269514722, 1e-7);
  EXPECT_NEAR(normal_quantile(0.99), 2.3263478740408408, 1e-7);
}

TEST(Population, names_outside_of_it_are_refused) {
  for (const char* name : {"q00", "seed:", "seed:x", "seed:-1", "q100", "banana", "q5"})
    EXPECT_FALSE(find_specimen(name).has_value()) << name;
}

TEST(Fsr, loses_16_percent_on_average_nearly_linearly_and_some_specimens_rise) {
  std::vector<double> losses;
  double gain_change = 0.0;
  for (int n = 1; n <= 30; ++n) {
    BenchRun bench{.rig_options = {{"sensor", "fsr"}}};
    bench.request.specimen = "seed:" + std::to_string(n);
    const Maxima m =
        find_maxima(bench.play(*stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.0}, {"m_N", 2.4}})), 0.5);
    const double start = m.swing_V(0.0, 60.0), middle = m.swing_V(570.0, 630.0),
                 end = m.swing_V(1140.0, 1200.0);
    losses.push_back(1.0 - end / start);
    gain_change += (middle / start - 0.5 * (1.0 + end / start)) / 30.0;
  }
  double mean = 0, lowest = 1, largest = -1;
  for (const double l : losses) {
    mean += l / 30.0;
    lowest = std::min(lowest, l);
    largest = std::max(largest, l);
  }
  std::printf(
      " FSR loss in 20 min: mean %.1f %%, %.1f .. %.1f %%; departure of the middle from the chord %.1f %%\n",
      100 * mean, 100 * lowest, 100 * largest, 100 * gain_change);
  EXPECT_NEAR(mean, 0.16, 0.04);
  EXPECT_LT(largest, 0.36);
  EXPECT_LT(lowest, 0.0);
  EXPECT_LT(std::abs(gain_change), 0.02);
}

TEST(Fsr, maxima_wander_as_in_figure_7) {
  const auto wander = [](const char* sensor) {
    BenchRun bench{.rig_options = {{"sensor", sensor}}};
    const Maxima m =
        find_maxima(bench.play(*stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 0.4}, {"m_N", 3.5}})), 0.3);
    double sum = 0.0;  // against the mean of the neighbours half a minute away: slow trends drop out
    int n = 0;
    for (std::size_t i = 15; i + 15 < m.maximum_V.size(); ++i, ++n) {
      const double d = m.maximum_V[i] - 0.5 * (m.maximum_V[i - 15] + m.maximum_V[i + 15]);
      sum += d * d;
    }
    return std::sqrt(sum / n) / m.swing_V(0.0, 60.0);
  };
  EXPECT_GT(wander("fsr"), 4.0 * wander("flexiforce"));
}

}  // namespace
}  // namespace forcegate::test
