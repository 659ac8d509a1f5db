#include "hil/diagnose/between/mounting_places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

using Eigen::Index;

TEST(MountingPlaces, TwoMountingsAtLeastHaveTwoRecords) {
  const std::vector<std::vector<int>> places = places_of_mountings(6, 2);
  EXPECT_NE(std::ranges::find(places, std::vector<int>{3, 5}), places.end()) << "two, two, two";
  EXPECT_NE(std::ranges::find(places, std::vector<int>{3, 6}), places.end()) << "two, three, one";
  EXPECT_EQ(std::ranges::find(places, std::vector<int>{2, 6}), places.end()) << "one, four, one";
}

TEST(MountingPlaces, WhereThereAreTooManyTheLibraryListsNone) {
  const EffectKind& mounting = *EffectRegistry::instance().find("mounting");
  for (const auto& [form, steps] : {std::pair{"two_steps", 2}, std::pair{"three_steps", 3}})
    for (std::size_t records = 6; records <= 40; ++records) {
      CampaignInput campaign;
      campaign.records.resize(records);
      EXPECT_EQ(find_form(mounting, form)->grid(campaign).empty(), places_of_mountings(static_cast<Index>(records), steps).empty()) << form << ' ' << records;
    }
}

TEST(MountingPlaces, EachMountingHasOneLevel) {
  const RecordPredictor p = predictor_of_places(5, {3, 5});
  Eigen::MatrixXd expected(5, 3);
  expected << 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1;
  EXPECT_EQ(p.column, expected);
}

// Ten records, some of them minutes apart and some of them hours.
RecordSeries at_times(Rng& rng, double scatter) {
  RecordSeries out;
  out.value.resize(10);
  out.variance = Eigen::VectorXd::Constant(10, 1e-8);
  out.typical_scatter = 6e-3;
  double now = 0.0;
  for (Index i = 0; i < 10; ++i) {
    now += i % 3 == 2 ? 3000.0 : 400.0;
    out.start_s.push_back(now);
    out.value[i] = scatter * rng.normal();
  }
  return out;
}

double gain_of_steps(const RecordSeries& series) {
  std::vector<RecordPredictor> predictors;
  for (const int steps : {2, 3})
    for (const std::vector<int>& places : places_of_mountings(series.value.size(), steps)) {
      RecordPredictor p = predictor_of_places(series.value.size(), places);
      normalise(p);
      p.alone = true;
      predictors.push_back(std::move(p));
    }
  std::vector<double> gains;
  for (const RecordScore& s : score_predictors(series, predictors, {0.003, 0.01, 0.03, 0.1})) gains.push_back(s.gain);
  return log_mean_exp(gains);
}

TEST(MountingPlaces, StepsAreSeenAndACourseOverTheTimeIsNone) {
  constexpr double kSeen = 3.0;  // nats
  Rng rng(21, "places");
  int steps = 0;
  for (int k = 0; k < 10; ++k) {
    RecordSeries s = at_times(rng, 0.002);
    for (Index i = 0; i < 10; ++i) s.value[i] += i < 3 ? 0.0 : i < 7 ? 0.06 : -0.04;
    steps += gain_of_steps(s) > kSeen ? 1 : 0;
  }
  EXPECT_GE(steps, 9);
  for (int k = 0; k < 20; ++k) {
    RecordSeries walk = at_times(rng, 0.002), smooth = at_times(rng, 0.002);
    double at = 0.0;
    for (Index i = 0; i < 10; ++i) {
      const double since_s = walk.start_s[static_cast<std::size_t>(i)] - (i > 0 ? walk.start_s[static_cast<std::size_t>(i - 1)] : 0.0);
      walk.value[i] += at += 0.001 * std::sqrt(since_s) * rng.normal();
      smooth.value[i] += 0.06 * std::sin(walk.start_s[static_cast<std::size_t>(i)] / 3000.0 + k);
    }
    EXPECT_LT(gain_of_steps(walk), kSeen) << k;
    EXPECT_LT(gain_of_steps(smooth), kSeen) << k;
  }
}

}  // namespace
}  // namespace forcegate::diagnose
