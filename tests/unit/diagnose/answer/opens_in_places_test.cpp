#include "hil/diagnose/answer/opens_in_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRow_s = 0.02;

/// A force that follows what the rig's law makes of its drive, and stands at zero below it.
RecordInput record(const std::string& name, const std::function<double(double)>& law_N, double noise_N = 0.005) {
  Rng rng(3, name);
  RecordInput r;
  r.name = name;
  for (int i = 0; i < 2000; ++i) {
    const double t = kRow_s * i, L = law_N(t);
    r.t_s.push_back(t);
    r.rig_force_N.push_back(L);
    r.F_N.push_back(std::max(0.0, L) + noise_N * rng.normal());
    r.ok.push_back(1);
  }
  return r;
}

double cycles(double t, double lowest_N) { return 2.0 + lowest_N - 2.0 * std::cos(2.0 * std::numbers::pi * 0.5 * t); }

Workspace workspace(std::vector<RecordInput> records) {
  Workspace w;
  w.input.range_N = 4.0;
  w.input.has_theta = true;
  w.input.records = std::move(records);
  w.has_rig = true;
  w.rig.unit = "N";
  w.rig.shown_in = ShownIn::rig;
  return w;
}

RecordInput closed() { return record("closed", [](double t) { return cycles(t, 0.2); }); }
RecordInput opening() { return record("opening", [](double t) { return cycles(t, -0.3); }); }

TEST(OpensInPlaces, IsClaimedOfOneRecordInWhichItHappensAgainAndAgain) {
  const auto found = contact_that_opens(workspace({closed(), opening(), closed()}), {});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->effect, "contact_loss");
  EXPECT_EQ(found->side, "rig");
  EXPECT_EQ(found->form, "in_places");
  EXPECT_TRUE(found->claimed());
  EXPECT_THAT(found->evidence, ::testing::HasSubstr("in opening the force comes to stand at its zero 19 times"));
  EXPECT_LT(found->error_after, 0.2 * found->error_before);
  EXPECT_EQ(found->records_excited, 1);
  ASSERT_EQ(found->series.size(), 2u);
  for (const EvidenceSeries& s : found->series) {
    EXPECT_THAT(s.title, ::testing::EndsWith("in opening"));
    const double before = *std::ranges::max_element(s.before), after = *std::ranges::max_element(s.after);
    EXPECT_NEAR(before, 0.3, 0.03) << s.x_name;
    EXPECT_LT(after, 0.05) << s.x_name;
  }
}

TEST(OpensInPlaces, IsNothingWhereTheContactStaysClosed) { EXPECT_FALSE(contact_that_opens(workspace({closed(), closed()}), {}).has_value()); }

TEST(OpensInPlaces, IsSeenAgainstACommandThatMadeNoLaw) {
  std::vector<RecordInput> records{closed(), opening()};
  for (RecordInput& r : records) r.F_cmd_N = std::move(r.rig_force_N), r.rig_force_N.clear();
  EXPECT_TRUE(contact_that_opens(workspace(std::move(records)), {}).has_value());
}

TEST(OpensInPlaces, NeedsNoNoise) {
  EXPECT_TRUE(contact_that_opens(workspace({record("even", [](double t) { return cycles(t, -0.3); }, 0.0)}), {}).has_value());
}

TEST(OpensInPlaces, IsSeenBesideAWheelThatBounces) {
  RecordInput r = opening();
  double closes_s = -1.0;
  for (std::size_t i = 1; i < r.rows(); ++i) {
    if (r.rig_force_N[i] > 0.0 && r.rig_force_N[i - 1] <= 0.0) closes_s = r.t_s[i];
    if (closes_s >= 0.0 && r.rig_force_N[i] > 0.0) r.F_N[i] = std::max(0.0, r.F_N[i] + 0.5 * std::exp(-(r.t_s[i] - closes_s) / 0.1) * std::sin(60.0 * (r.t_s[i] - closes_s)));
  }
  EXPECT_TRUE(contact_that_opens(workspace({closed(), r}), {}).has_value());
}

// A protocol that begins and ends with a gap, and one load between: nothing opens between two loads.
TEST(OpensInPlaces, IsNotAGapBeforeAndAfterTheLoad) {
  const auto once = [](double t) { return t < 10.0 || t > 30.0 ? -0.5 + 0.01 * t : 2.0 + 0.1 * t; };
  EXPECT_FALSE(contact_that_opens(workspace({record("one", once), record("two", once)}), {}).has_value());
}

// A spring that softens at the bottom goes on to fall.
TEST(OpensInPlaces, IsNotABentSpring) {
  RecordInput r = opening();
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.rig_force_N[i] < 0.0) r.F_N[i] = 0.4 * r.rig_force_N[i];
  EXPECT_FALSE(contact_that_opens(workspace({closed(), r}), {}).has_value());
}

// Nor a drive that scatters by as much as the law would be below zero.
TEST(OpensInPlaces, IsNotSeenInTheNoise) { EXPECT_FALSE(contact_that_opens(workspace({record("noisy", [](double t) { return cycles(t, -0.3); }, 0.15)}), {}).has_value()); }

TEST(OpensInPlaces, IsToldOnce) {
  Finding told;
  told.effect = "contact_loss";
  told.probability = 0.98;
  EXPECT_FALSE(contact_that_opens(workspace({opening()}), {told}).has_value());
}

}  // namespace
}  // namespace forcegate::diagnose
