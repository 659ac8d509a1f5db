#include "hil/diagnose/raw/sample_windows.h"

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

std::vector<double>& output_of(Campaign& c, int record) { return c.records[static_cast<std::size_t>(record)].trace.find("U")->value; }

// The finding of that effect, as a diagnosis with pictures tells it.
Finding finding_of(Campaign c, const std::string& effect) {
  const Diagnosis d = answer(std::move(c));
  for (const Finding& f : d.findings)
    if (f.effect == effect) return f;
  ADD_FAILURE() << effect << " was not found: " << told(d);
  return {};
}

void expect_sound(const SampleWindow& w) {
  ASSERT_FALSE(w.t_s.empty());
  EXPECT_EQ(w.t_s.size(), w.recorded.size());
  EXPECT_EQ(w.t_s.size(), w.beside.size());
  EXPECT_EQ(w.named_t_s.size(), w.named.size());
  EXPECT_TRUE(std::ranges::is_sorted(w.t_s));
  for (const double t : w.named_t_s) EXPECT_TRUE(std::ranges::binary_search(w.t_s, t)) << "a named sample is not drawn";
}

TEST(SampleWindows, HeldSamplesAreShownBesideWhatTheForceSays) {
  Campaign c = make_campaign(31, straight);
  std::vector<double>& U = output_of(c, 3);
  for (std::size_t i = 900; i < 20000; i += 1500)
    for (std::size_t k = 1; k < 30; ++k) U[i + k] = U[i];
  output_of(c, 7) = U;  // the same force
  const Finding f = finding_of(std::move(c), "dropouts");
  ASSERT_EQ(f.samples.size(), 1u);
  const SampleWindow& w = f.samples.front();
  expect_sound(w);
  EXPECT_EQ(w.quantity, "output");
  EXPECT_EQ(w.unit, "V");
  ASSERT_GE(w.named.size(), 29u);
  EXPECT_LT(w.named.size(), w.t_s.size());
  // around the named ones the dashed line is the output
  for (std::size_t i = 0; i < w.t_s.size(); ++i) {
    if (std::ranges::binary_search(w.named_t_s, w.t_s[i])) continue;
    EXPECT_NEAR(w.recorded[i], w.beside[i], 0.15) << w.t_s[i];
  }
}

TEST(SampleWindows, SpikesAreNamedAndTheirNeighboursAreNot) {
  Campaign spiky = make_campaign(32, straight);
  for (const int k : {0, 3})
    for (std::size_t i = 500; i < 20000; i += 700) output_of(spiky, k)[i] += 2.0;
  const Finding spikes = finding_of(std::move(spiky), "outliers");
  ASSERT_EQ(spikes.samples.size(), 1u);
  expect_sound(spikes.samples.front());
  ASSERT_FALSE(spikes.samples.front().named.empty());
  for (std::size_t k = 0; k < spikes.samples.front().named.size(); ++k) {
    const SampleWindow& w = spikes.samples.front();
    const auto at = std::ranges::lower_bound(w.t_s, w.named_t_s[k]) - w.t_s.begin();
    EXPECT_NEAR(w.named[k] - w.beside[static_cast<std::size_t>(at)], 2.0, 0.2);
  }
}

TEST(SampleWindows, ARailIsShownWithTheForceThatGoesOn) {
  Campaign c = make_campaign(33, straight);
  Record& r = c.records[3];
  RecordHealth health = check_raw_health(r, health_scales(c), c.bench);
  std::vector<double>& U = output_of(c, 3);
  for (std::size_t i = 0; i < U.size(); ++i)
    if (U[i] > 6.5) U[i] = 6.5, health.bad[i] = static_cast<std::uint8_t>(BadSample::rail);
  std::vector<HealthClaim> claims = {{"clipping", 0.95, "", "rail_V", "V", 6.5, 0.0, {}}, {"hum", 0.95, "", "", "", 0.0, 0.0, {}}};
  add_sample_windows(cut_out_bad_samples(r, health, health_scales(c)), claims);
  EXPECT_TRUE(claims[1].samples.empty()) << "a rail is no picture of hum";
  ASSERT_EQ(claims[0].samples.size(), 1u);
  const SampleWindow& w = claims[0].samples.front();
  expect_sound(w);
  ASSERT_FALSE(w.named.empty());
  for (const double u : w.named) EXPECT_DOUBLE_EQ(u, 6.5);
  EXPECT_GT(std::ranges::max(w.beside), 7.5);
}

TEST(SampleWindows, HumIsShownAsRecordedAndWithoutTheLine) {
  Campaign c = make_campaign(34, straight);
  for (int k = 0; k < 8; ++k) {
    std::vector<double>& U = output_of(c, k);
    for (std::size_t i = 0; i < U.size(); ++i) U[i] += 0.2 * std::sin(2.0 * std::numbers::pi * 50.0 * static_cast<double>(i) / 200.0 + 0.5);
  }
  const Finding f = finding_of(std::move(c), "hum");
  ASSERT_EQ(f.samples.size(), 1u);
  const SampleWindow& w = f.samples.front();
  expect_sound(w);
  EXPECT_TRUE(w.named.empty());
  double square = 0.0;
  for (std::size_t i = 0; i < w.t_s.size(); ++i) square += (w.recorded[i] - w.beside[i]) * (w.recorded[i] - w.beside[i]);
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(w.t_s.size())), 0.2 / std::numbers::sqrt2, 0.03) << "what was taken off is the line";
}

TEST(SampleWindows, ANoisyReferenceIsShownInNewtonsWhereItMovesLeast) {
  Campaign c = make_campaign(35, straight);
  c.bench.reference_noise_N = 0.005;
  Rng rng(35, "reference");
  for (Record& r : c.records)
    for (double& f : r.trace.find("F_ref")->value) f += 0.08 * rng.normal();
  const Finding f = finding_of(std::move(c), "reference_noise");
  ASSERT_EQ(f.samples.size(), 1u);
  const SampleWindow& w = f.samples.front();
  expect_sound(w);
  EXPECT_EQ(w.unit, "N");
  const auto [low, high] = std::ranges::minmax(w.beside);
  EXPECT_LT(high - low, 0.2);
  const auto [least, most] = std::ranges::minmax(w.recorded);
  EXPECT_GT(most - least, 0.2);
}

TEST(SampleWindows, WithoutPicturesNothingIsKept) {
  Campaign c = make_campaign(32, straight);
  for (const int k : {0, 3})
    for (std::size_t i = 500; i < 20000; i += 700) output_of(c, k)[i] += 2.0;
  EngineOptions options;
  options.pictures = false;
  const auto d = diagnose_campaign(std::move(c), options);
  ASSERT_TRUE(d.has_value());
  ASSERT_FALSE(d->findings.empty());
  EXPECT_EQ(d->findings.front().effect, "outliers");
  EXPECT_TRUE(d->findings.front().samples.empty());
}

TEST(SampleWindows, AHoleInTheReferenceIsNotWhereItMovesLeast) {
  Campaign c = make_campaign(40, straight);
  Record& r = c.records[3];
  std::vector<double>& F = r.trace.find("F_ref")->value;
  for (std::size_t i = 2000; i < 2800; ++i) F[i] = kMissing;
  const CutOut cut = cut_out_reference_noise(r, F, 1.0);
  ASSERT_FALSE(cut.window.recorded.empty());
  const auto there = std::ranges::count_if(cut.window.recorded, [](double v) { return std::isfinite(v); });
  EXPECT_GE(2 * there, static_cast<std::ptrdiff_t>(cut.window.recorded.size()));
  std::ranges::fill(F, kMissing);
  EXPECT_TRUE(cut_out_reference_noise(r, F, 1.0).window.recorded.empty()) << "there is nothing to show";
}

}  // namespace
}  // namespace forcegate::diagnose
