#include "hil/app/pictures/record_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/rng.h"

namespace forcegate {
namespace {

// Static records of a linear sensor: sine of 0.1 Hz, a line of `line_Hz` in the output alone, a zero that moves from record to record.
diagnose::Workspace workspace(std::size_t records, double line_Hz, double zero_step_V) {
  diagnose::Workspace w;
  Rng rng(7, "record pictures");
  for (std::size_t k = 0; k < records; ++k) {
    RecordInput r;
    r.name = "r" + std::to_string(k);
    r.start_s = 600.0 * static_cast<double>(k);
    for (int i = 0; i < 5000; ++i) {
      const double t = 0.02 * i, F = 2.0 + std::sin(2.0 * std::numbers::pi * 0.1 * t);
      r.t_s.push_back(t);
      r.F_N.push_back(F);
      r.U_V.push_back(2.0 * F + 0.01 * std::sin(2.0 * std::numbers::pi * line_Hz * t) + zero_step_V * static_cast<double>(k) + 0.001 * rng.normal());
      r.ok.push_back(1);
      r.decay.push_back(1.0);
    }
    w.input.records.push_back(std::move(r));
    w.noise_V.push_back(0.001);
  }
  return w;
}

TEST(RecordPictures, TheSpectrumHasALineWhereTheOutputHasOneOfItsOwn) {
  const RecordPictures p = record_pictures(workspace(1, 7.0, 0.0), Model{});
  ASSERT_EQ(p.spectra.size(), 1u);
  const ResidualSpectrum& s = p.spectra.front();
  const auto peak = std::max_element(s.residual.begin(), s.residual.end()) - s.residual.begin();
  EXPECT_NEAR(s.f_Hz[static_cast<std::size_t>(peak)], 7.0, 0.1);
  std::vector<double> sorted = s.residual;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  EXPECT_NEAR(sorted[sorted.size() / 2] / s.noise, 1.0, 0.15);  // white noise elsewhere, in its own density
}

TEST(RecordPictures, TheLoadsOwnLinesAreThoseOfItsCommandOrOfTheAngle) {
  diagnose::Workspace w = workspace(1, 7.0, 0.0);
  RecordInput& r = w.input.records.front();
  EXPECT_TRUE(record_pictures(w, Model{}).spectra.front().command.empty());
  const auto peak_Hz = [&] {
    const ResidualSpectrum s = record_pictures(w, Model{}).spectra.at(0);
    return s.command.size() == s.f_Hz.size() ? s.f_Hz[static_cast<std::size_t>(std::ranges::max_element(s.command) - s.command.begin())] : 0.0;
  };
  for (const double t : r.t_s) r.F_cmd_N.push_back(2.0 + std::sin(2.0 * std::numbers::pi * 3.0 * t));
  EXPECT_NEAR(peak_Hz(), 3.0, 0.1);
  r.F_cmd_N[100] = NAN;
  EXPECT_EQ(peak_Hz(), 0.0) << "a row without a command tells nothing";
  r.F_cmd_N.clear();
  for (const double t : r.t_s) r.theta_rad.push_back(1.5 + 0.1 * std::sin(2.0 * std::numbers::pi * 5.0 * t));
  EXPECT_NEAR(peak_Hz(), 5.0, 0.1);
}

TEST(RecordPictures, TurningPointsAreThoseOfTheForce) {
  const RecordPictures p = record_pictures(workspace(1, 7.0, 0.0), Model{});
  ASSERT_EQ(p.extrema.size(), 1u);
  EXPECT_EQ(p.extrema.front().maxima.t_s.size(), 10u);
  EXPECT_NEAR(p.extrema.front().maxima.modelled.front(), 6.0, 0.01);
}

TEST(RecordPictures, ARigLawWithAZeroOfEachRecordsOwnTellsNothingOfTheReference) {
  diagnose::Workspace w = workspace(3, 7.0, 0.0);
  for (RecordInput& r : w.input.records) r.rig_force_N = r.F_N;
  EXPECT_TRUE(std::isnan(record_pictures(w, Model{}).levels[0].reference_N));
  w.rig_shows = RigShows::zero_of_records;
  EXPECT_NEAR(record_pictures(w, Model{}).levels[0].reference_N, 0.0, 1e-12);
}

TEST(RecordPictures, AZeroThatMovesStandsFarOutsideItsWhiskers) {
  const RecordPictures p = record_pictures(workspace(5, 7.0, 0.02), Model{});
  ASSERT_EQ(p.levels.size(), 5u);
  EXPECT_NEAR(p.levels[4].zero - p.levels[0].zero, 0.08, 0.001);
  EXPECT_LT(p.levels[4].u_zero, 0.002);
  EXPECT_NEAR(p.levels[4].gain_pct, 0.0, 0.1);
  EXPECT_TRUE(std::isnan(p.levels[4].reference_N));
}

TEST(RecordPictures, AModelsCurveIsDrawnWithTheSpanThatItWasFittedOn) {
  diagnose::Workspace w = workspace(1, 7.0, 0.0);
  for (std::size_t i = 0; i < 5000; ++i) {
    const double F = w.input.records[0].F_N[i];
    w.input.records[0].U_V[i] = 2.0 * (F + 0.3 * F * F / 5.0);
  }
  w.input.range_N = 2.0;
  const auto model = parse_model("[law]\nspan_N = 5.0\ngain_N_per_V = 0.5\noffset_N = 0.0\n[[effect]]\nname = \"static_nonlinearity\"\n"
                                 "form = \"polynomial\"\nstrength.c2 = 0.3\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  const RecordPictures p = record_pictures(w, *model);
  ASSERT_EQ(p.extrema.size(), 1u);
  EXPECT_NEAR(p.extrema.front().maxima.modelled.front(), p.extrema.front().maxima.measured.front(), 1e-6);
}

TEST(RecordPictures, BesideEffectsTheDecayIsTheModelsAndNotThatOfTheLawAlone) {
  diagnose::Workspace w = workspace(1, 7.0, 0.0);
  const auto model = parse_model("[law]\nspan_N = 5.0\ngain_N_per_V = 0.5\noffset_N = 0.0\n[[effect]]\nname = \"static_nonlinearity\"\n"
                                 "form = \"polynomial\"\nstrength.c2 = 0.3\n", "m.toml");
  ASSERT_TRUE(model) << model.error().to_text();
  RecordInput& r = w.input.records[0];
  r.dynamic = true;
  r.f_Hz = 0.1, r.A_N = 1.0, r.F_min_N = 1.0;
  w.input.range_N = 5.0;
  set_decay(r, model->law);
  const auto output = model_output_V(*model, CampaignInFrame(model->frame, w.input), r);
  ASSERT_TRUE(output);
  r.U_V = *output;
  set_decay(r, model->law, 0.7, 0.7);  // what the law alone would make of the effect
  const RecordPictures p = record_pictures(w, *model);
  ASSERT_EQ(p.extrema.size(), 1u);
  const TurningSeries& maxima = p.extrema.front().maxima;
  for (std::size_t i = 0; i < maxima.t_s.size(); ++i) EXPECT_NEAR(maxima.modelled[i], maxima.measured[i], 1e-6) << maxima.t_s[i];
}

TEST(RecordPictures, WhatTheRecordsCannotShowIsSaid) {
  diagnose::Workspace w = workspace(1, 7.0, 0.0);
  for (std::size_t i = 0; i < 5000; ++i) w.input.records[0].ok[i] = i % 100 < 60 ? 1 : 0;
  const RecordPictures p = record_pictures(w, Model{});
  EXPECT_TRUE(p.spectra.empty());
  ASSERT_EQ(p.missing.size(), 3u);
  EXPECT_NE(p.missing[0].find("No spectrum"), std::string::npos);
  EXPECT_NE(p.missing[1].find("turns four times up"), std::string::npos);
  EXPECT_NE(p.missing[2].find("three records"), std::string::npos);
}

}  // namespace
}  // namespace forcegate
