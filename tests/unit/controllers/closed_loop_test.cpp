// Force control on the emulated rig (Lebosse 2011, IV-B2, Fig. 9-11): 1.1 to 3.2 N at 0.5 Hz and four sines,
// 20 min.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "hil/base/parallel.h"
#include "hil/trace/extrema.h"
#include "tests/unit/controllers/compensator.h"
#include "tests/unit/emulated/bench_run.h"

namespace forcegate::test {
namespace {

using namespace emulated;

struct Outcome {
  double first_stop_s = -1.0, stopped_share_at_end = 0.0;
  double mre_maxima = 0.0, mre_minima = 0.0;
};

std::unique_ptr<Stimulus> one_sine() {
  return stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}});
}
std::unique_ptr<Stimulus> four_sines() {
  return stimulus("multisine", {{"m_N", 2.15}},
                  {{"f_Hz", {1.0, 0.5, 0.1, 0.05}}, {"A_N", {0.1, 0.2, 0.3, 0.4}}});
}

/// ATI against set-point from `from_s` on.
Outcome control(const std::string& name, std::uint64_t session, Level level, const Stimulus& profile,
                double f_min_Hz, double from_s) {
  const Specimen specimen = value_or_abort(find_specimen(name));
  BenchRun bench;
  bench.controller = "force_integral";
  bench.request.specimen = name;
  bench.request.seed = 7;
  bench.request.session = session;
  const FilmParameters film = draw_session(SensorType::flexiforce, specimen, 7, session);
  bench.estimator = Compensator(level, specimen, film, f_min_Hz);
  const RigBlock b = bench.play(profile);
  Outcome o;
  ExtremaPairer pairer({.prominence = 0.3, .followers = 1, .half_width = 5});
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double ati = static_cast<double>(b.force_ref_N[i]);
    pairer.push(b.t_s[i], static_cast<double>(b.setpoint_N[i]), &ati);
    if (b.status[i] & kRigTravelStop) {
      if (o.first_stop_s < 0.0) o.first_stop_s = b.t_s[i];
      if (b.t_s[i] >= 900.0) o.stopped_share_at_end += 1.0 / 300000.0;
    }
  }
  pairer.finish();
  std::vector<double> actual[2], expected[2];
  for (const PairedExtremum& e : pairer.pairs()) {
    if (e.t_s < from_s) continue;
    const auto k = static_cast<std::size_t>(e.turn == Turn::minimum);
    actual[k].push_back(e.value[0]);
    expected[k].push_back(e.guide);
  }
  o.mre_maxima = mean_relative_error(actual[0], expected[0], 0.5).mean;
  o.mre_minima = mean_relative_error(actual[1], expected[1], 0.5).mean;
  return o;
}

struct PanelMean {
  double maxima = 0, minima = 0;
};

PanelMean panel_mean(Level level, const Stimulus& profile, double f_min_Hz, double from_s) {
  const auto& names = panel_names();
  std::vector<Outcome> outcomes(names.size());
  parallel_for(names.size(), 0,
               [&](std::size_t i) { outcomes[i] = control(names[i], i, level, profile, f_min_Hz, from_s); });
  PanelMean mean;
  for (const Outcome& o : outcomes) {
    mean.maxima += o.mre_maxima / static_cast<double>(names.size());
    mean.minima += o.mre_minima / static_cast<double>(names.size());
  }
  return mean;
}

TEST(ClosedLoop, without_compensation_the_wheel_reaches_its_stop_mostly_between_100_and_320_s) {
  const auto profile = one_sine();
  std::vector<Outcome> outcomes(30);
  parallel_for(outcomes.size(), 0, [&](std::size_t i) {
    outcomes[i] = control("seed:" + std::to_string(i + 1), i, Level::off, *profile, 0.5, 20.0);
  });
  int inside = 0, never = 0;
  double at_end = 0.0;
  std::vector<double> stops;
  for (const Outcome& o : outcomes) {
    inside += o.first_stop_s >= 100.0 && o.first_stop_s <= 320.0;
    never += o.first_stop_s < 0.0;
    at_end += o.stopped_share_at_end / 30.0;
    stops.push_back(o.first_stop_s);
  }
  std::sort(stops.begin(), stops.end());
  std::printf(
      " stop reached by %d of 30 in 100-320 s, median %.0f s, %d never; at the stop %.0f %% of the last 5 "
      "min\n",
      inside, stops[15], never, 100.0 * at_end);
  EXPECT_GE(inside, 24);
  EXPECT_EQ(never, 0);
}

TEST(ClosedLoop, with_identified_calibration_the_panel_keeps_the_papers_limits_with_margin) {
  const auto profile = one_sine();
  const PanelMean identified = panel_mean(Level::identified, *profile, 0.5, 20.0);
  const PanelMean statical = panel_mean(Level::statical, *profile, 0.5, 20.0);
  const PanelMean nominal = panel_mean(Level::nominal, *profile, 0.5, 20.0);
  std::printf(
      " panel mean MRE maxima / minima: identified %.1f / %.1f %%, static %.1f / %.1f %%, nominal %.1f / "
      "%.1f %%\n",
      100 * identified.maxima, 100 * identified.minima, 100 * statical.maxima, 100 * statical.minima,
      100 * nominal.maxima, 100 * nominal.minima);
  EXPECT_LT(identified.maxima, 0.035);
  EXPECT_LT(identified.minima, 0.035);
  EXPECT_GT(statical.maxima, identified.maxima);
  EXPECT_GT(nominal.maxima, 0.055);  // clearly beyond the paper's 4.5 %
}

TEST(ClosedLoop, four_sines_stay_below_the_papers_figures_at_the_end_of_20_minutes) {
  const auto profile = four_sines();
  const PanelMean mean = panel_mean(Level::identified, *profile, 0.05, 1080.0);
  std::printf(" four sines, identified, last 2 min: %.1f / %.1f %%\n", 100 * mean.maxima, 100 * mean.minima);
  EXPECT_LT(mean.maxima, 0.15);
  EXPECT_LT(mean.minima, 0.18);
}

TEST(ClosedLoop, control_error_alone_leaves_margin) {
  // The reference cell itself is fed back through a perfect estimate: a film that neither decays nor errs.
  BenchRun bench;
  const auto rig = value_or_abort(make_rig("emulated", {{"session_spread", "off"}}));
  const auto profile = stimulus("sine", {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}, {"duration_s", 60.0}});
  bench.controller = "force_integral";
  bench.estimator = [&](std::uint16_t) { return rig->force_ref_N(); };
  const RigBlock b = bench.play(*rig, *profile);
  float low = 10, high = 0;
  for (std::size_t i = 10000; i < b.size(); ++i) {
    low = std::min(low, b.force_ref_N[i]);
    high = std::max(high, b.force_ref_N[i]);
  }
  EXPECT_NEAR(high, 3.2F, 0.065F);  // 2 %
  EXPECT_NEAR(low, 1.1F, 0.045F);   // 4 %
}

TEST(ClosedLoop, controller_begins_where_the_wheel_is_and_settles_without_oscillation) {
  BenchRun bench;
  const auto rig = value_or_abort(make_rig("emulated", {{"session_spread", "off"}}));
  const auto profile =
      stimulus("step", {{"low_N", 1.5}, {"high_N", 3.0}, {"at_s", 2.0}, {"duration_s", 6.0}});
  bench.controller = "force_integral";
  bench.estimator = [&](std::uint16_t) { return rig->force_ref_N(); };
  const RigBlock b = bench.play(*rig, *profile);
  for (std::size_t i = 0; i < 2000; ++i) EXPECT_NEAR(b.force_ref_N[i], 1.5F, 0.08F);
  float high = 0;
  for (std::size_t i = 2000; i < b.size(); ++i) high = std::max(high, b.force_ref_N[i]);
  EXPECT_LT(high, 3.15F);
  for (std::size_t i = 3000; i < b.size(); ++i) EXPECT_NEAR(b.force_ref_N[i], 3.0F, 0.08F);
}

}  // namespace
}  // namespace forcegate::test
