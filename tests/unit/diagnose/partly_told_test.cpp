// A gain that goes with the drive, in a campaign of which some records do not say how they were driven.

#include "hil/diagnose/partly_told.h"

#include <gmock/gmock.h>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kDrive_V[] = {5.0, 3.0, 2.0, 4.0, 3.5, 2.5, 4.5, 2.2};

Campaign driven(double per_V, const std::vector<std::size_t>& silent) {
  Campaign c = make_campaign(71, [&](const auto&, const auto& F, int record) {
    std::vector<double> U;
    for (const double f : F) U.push_back(0.2 + 2.0 * f * (1.0 + per_V * (kDrive_V[record] - 3.0)));
    return U;
  });
  for (std::size_t k = 0; k < c.records.size(); ++k) c.records[k].drive_V = kDrive_V[k];
  for (const std::size_t k : silent) c.records[k].drive_V.reset();
  return c;
}

TEST(PartlyTold, ACauseIsAskedOfTheRecordsThatTellIt) {
  const Diagnosis d = answer(driven(0.03, {1, 6}));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  EXPECT_GE(probability(d, "bias"), 0.9) << told(d);
  EXPECT_THAT(d.notes, Contains(HasSubstr("r1, r6 have no drive_V, as a key or a column: this is the answer of the other 6 records alone")));
}

TEST(PartlyTold, WhatDoesNotGoWithItIsNotClaimed) {
  const Diagnosis d = answer(driven(0.0, {1, 6}));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_EQ(d.records.size(), 8U);
}

TEST(PartlyTold, FewRecordsOrOneValueAreNotAsked) {
  EXPECT_TRUE(partly_told(driven(0.03, {})).empty()) << "all tell it";
  EXPECT_TRUE(partly_told(driven(0.03, {0, 1, 2, 3})).empty()) << "four do";
  Campaign one = driven(0.03, {1, 6});
  for (Record& r : one.records)
    if (r.drive_V) r.drive_V = 5.0;
  EXPECT_TRUE(partly_told(one).empty());
  const std::vector<PartlyTold> asked = partly_told(driven(0.03, {1, 6}));
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked.front().effect, "bias");
  EXPECT_THAT(asked.front().silent, ElementsAre("r1", "r6"));
  EXPECT_EQ(asked.front().told.records.size(), 6U);
}

}  // namespace
}  // namespace forcegate::diagnose
