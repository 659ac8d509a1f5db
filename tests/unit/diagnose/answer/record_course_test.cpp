// The course of a record that is drawn: all of its rows, at the fit's own model.

#include "hil/diagnose/answer/record_course.h"

#include "hil/diagnose/answer/load_direction.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

std::vector<double> straight(const std::vector<double>&, const std::vector<double>& F, int) {
  std::vector<double> U;
  for (const double f : F) U.push_back(2.0 * f + 0.2);
  return U;
}

// The fourth record: a sine of 1 Hz for two minutes.
Campaign with_a_fast_record() {
  Campaign c = make_campaign(7, straight, 0.002);
  Record& r = c.records[3];
  for (std::size_t i = 0; i < r.trace.channels[0].value.size(); ++i) {
    const double F = 2.0 + std::sin(6.283185307179586 * r.trace.time_bases[0].t_s[i]);
    r.trace.channels[0].value[i] = F;
    r.trace.channels[1].value[i] = 2.0 * F + 0.2;
  }
  return c;
}

struct Fitted {
  std::unique_ptr<Workspace> w;
  MixedFit fit;
};

Fitted fitted(const std::vector<std::string>& in_model) {
  EngineOptions options;
  options.threads = 1;
  options.search = false;
  options.in_model = in_model;
  for (const std::string& name : in_model) {
    const EffectKind& kind = *EffectRegistry::instance().find(name);
    const EffectForm& form = kind.forms.front();
    std::vector<double> shape;
    for (const ParameterSpec& p : form.shape) shape.push_back(p.neutral);
    options.model_effects.push_back(model_effect(kind, form, shape, std::vector<Estimate>(form.strength.size())));
  }
  Fitted out;
  auto w = prepare(with_a_fast_record(), options);
  EXPECT_TRUE(w.has_value());
  out.w = std::move(*w);
  std::vector<std::string> notes;
  out.fit = base_model(*out.w, options, notes);
  EXPECT_TRUE(out.fit.valid);
  return out;
}

// What a late reference left was taken off the output: it is no part of what the model leaves.
TEST(RecordCourse, DoesNotBringBackWhatWasTakenOffTheOutput) {
  Fitted f = fitted({"hysteresis"});
  const int column = f.fit.columns.front();
  Eigen::VectorXd strength = Eigen::VectorXd::Zero(column + 1);  // the channel is wider
  strength[column] = 0.5;
  const double before = residual_rows(f.w->output, f.fit)[3][500];
  take_off_output(f.w->output, strength);
  const auto expected = residual_rows(f.w->output, f.fit);
  const auto got = residual_on_rows(*f.w, f.fit, 3, f.w->output.rows[3].row);
  EXPECT_GT(std::abs(expected[3][500] - before), 1e-3);
  for (std::size_t j = 0; j < got.size(); ++j) ASSERT_NEAR(got[j], expected[3][j], 1e-9) << j;
  take_off_output(f.w->output, -strength);
  EXPECT_EQ(f.w->output.taken_off, 0.0 * strength);
}

TEST(RecordCourse, OnTheRowsOfTheFitIsTheResidualOfTheFit) {
  for (const std::vector<std::string>& in_model : {std::vector<std::string>{}, {"hysteresis", "creep"}}) {
    const Fitted f = fitted(in_model);
    EXPECT_EQ(f.fit.columns.empty(), in_model.empty());
    const auto expected = residual_rows(f.w->output, f.fit);
    for (const std::size_t k : {0u, 3u}) {
      const auto got = residual_on_rows(*f.w, f.fit, k, f.w->output.rows[k].row);
      ASSERT_EQ(got.size(), expected[k].size());
      for (std::size_t j = 0; j < got.size(); ++j) ASSERT_NEAR(got[j], expected[k][j], 1e-9) << k << " " << j;
    }
  }
}

TEST(RecordCourse, OfAFastSineReachesItsPeaksInEveryStretchAndIsFollowedByAFewCycles) {
  const Fitted f = fitted({});
  const std::vector<EvidenceSeries> course = record_course(*f.w, f.fit, 3);
  ASSERT_EQ(course.size(), 2u);
  for (double from = 5.0; from < 115.0; from += 2.0) {
    double low = 1e9, high = -1e9;
    for (std::size_t i = 0; i < course[0].x.size(); ++i)
      if (course[0].x[i] >= from && course[0].x[i] < from + 2.0) low = std::min(low, course[0].before[i]), high = std::max(high, course[0].before[i]);
    EXPECT_NEAR(low, 2.2, 0.05) << from;
    EXPECT_NEAR(high, 6.2, 0.05) << from;
  }
  EXPECT_NEAR(course[1].x.back() - course[1].x.front(), 5.0, 0.1);
  EXPECT_GT(course[1].x.size(), 200u) << "every row";
  EXPECT_EQ(record_course(*f.w, f.fit, 0).size(), 1u);
}

TEST(LoadDirection, OfAHoldIsHeldWhateverTheNoiseAndOfARampItIsOneWay) {
  RecordInput r;
  Rng rng(3, "noise");
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.02 * i;
    r.t_s.push_back(t);
    r.F_N.push_back((t < 40.0 ? 0.05 * t : t < 80.0 ? 2.0 : 2.0 - 0.05 * (t - 80.0)) + 0.003 * rng.normal());
  }
  const std::vector<double> way = load_direction(r, 4.0);
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.02 * i;
    if (t > 5.0 && t < 37.0) { EXPECT_EQ(way[static_cast<std::size_t>(i)], 1.0) << t; }
    if (t > 43.0 && t < 77.0) { EXPECT_EQ(way[static_cast<std::size_t>(i)], 0.0) << t; }
    if (t > 83.0 && t < 117.0) { EXPECT_EQ(way[static_cast<std::size_t>(i)], -1.0) << t; }
  }
}

// The blocks of one recording share its full-rate force, which its first block holds: what is drawn of each is off by what the fit is off by.
TEST(RecordCourse, OfOneRecordingWithADelayIsThatOfTheFitInEveryBlock) {
  Campaign c;
  c.name = "machine";
  Record r;
  r.name = "one";
  TimeBase clock;
  std::vector<double> x, y;
  Rng rng(3, "one");
  const auto input = [](double t) { return 2.0 + 1.2 * std::sin(1.3 * t) + 0.5 * std::sin(3.1 * t + 1.0); };
  for (int i = 0; i < 20000; ++i) {
    const double t = i / 200.0;
    clock.t_s.push_back(t);
    x.push_back(input(t));
    y.push_back(2.0 * input(t - 0.06) + 0.1 + 0.004 * rng.normal());
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, x, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, y, {}});
  c.records.push_back(std::move(r));
  const Diagnosis d = answer(std::move(c));
  ASSERT_GE(probability(d, "delay"), 0.5) << told(d);
  ASSERT_FALSE(d.overlays.empty());
  for (const EvidenceSeries& s : d.overlays) {
    double square = 0.0, n = 0.0;
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (std::isfinite(s.before[i])) {
        square += std::pow(s.before[i] - s.after[i], 2);
        n += 1.0;
      }
    EXPECT_LT(std::sqrt(square / n), 0.02) << s.record << " " << s.title;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
