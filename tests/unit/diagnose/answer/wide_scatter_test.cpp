#include "hil/diagnose/answer/wide_scatter.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Eight records whose gain and zero are their own, without a word why.
Diagnosis answer_to(const std::function<double(int)>& gain, const std::function<double(int)>& zero) {
  Campaign campaign = make_campaign(7, [&](const std::vector<double>&, const std::vector<double>& F, int k) {
    std::vector<double> U;
    for (const double f : F) U.push_back(1.6 * gain(k) * f + 0.6 + zero(k));
    return U;
  });
  for (Record& record : campaign.records) record.start_s.reset();
  return answer(std::move(campaign));
}

double by_turns(int k) { return k % 3 == 0 ? 1.0 : k % 3 == 1 ? -1.0 : 0.2; }

bool tells(const Diagnosis& d, const std::string& part) {
  return std::ranges::any_of(d.notes, [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

TEST(WideScatter, AGainThatIsAnotherInEveryRecordIsUnknown) {
  const Diagnosis d = answer_to([](int k) { return 1.0 + 0.2 * by_turns(k); }, [](int) { return 0.0; });
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_EQ(d.depends_on, std::vector<std::string>{"time"});
  ASSERT_EQ(d.follows.size(), 1u) << told(d);
  EXPECT_TRUE(d.follows.front().starts_with("the record, whose gain scatters by ")) << d.follows.front();
  EXPECT_FALSE(tells(d, "zero scatters")) << told(d);
}

TEST(WideScatter, OneThatGoesOneWayIsUnknownWhereItIsSmaller) {
  const Diagnosis d = answer_to([](int) { return 1.0; }, [](int k) { return 0.06 * k; });
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown) << told(d);
  EXPECT_TRUE(tells(d, "the zero scatters by 0.0") && tells(d, "and rises from record to record in their order")) << told(d);
}

// Lebosse 2011, III-D: the gain of one sensor differs by 9 % from session to session.
TEST(WideScatter, WhatSessionsDifferByIsANote) {
  for (const double size : {0.045, 0.11}) {
    const Diagnosis d = answer_to([&](int k) { return 1.0 + size * by_turns(k); }, [](int) { return 0.0; });
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
    EXPECT_TRUE(tells(d, "no more than one does from session to session")) << told(d);
  }
}

TEST(WideScatter, WhatSpecimensRepeatToIsNothing) {
  const Diagnosis d = answer_to([](int k) { return 1.0 + 0.02 * by_turns(k); }, [](int k) { return 0.03 * by_turns(k); });
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_FALSE(tells(d, "far more than a specimen repeats to")) << told(d);
}

// A load cell that was never tared: zero lies far from all records, and a gain that scatters as it may moves it by much.
TEST(WideScatter, AZeroFarFromTheRecordsIsAskedWhereTheyAre) {
  Campaign campaign = make_campaign(9, [](const std::vector<double>&, const std::vector<double>& F, int k) {
    std::vector<double> U;
    for (const double f : F) U.push_back(1.6 * (1.0 + 0.012 * by_turns(k)) * f + 0.6);
    return U;
  });
  for (Record& record : campaign.records)
    for (double& f : record.trace.find("F_ref")->value) f += 40.0;
  const Diagnosis d = answer(std::move(campaign));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_FALSE(tells(d, "zero scatters")) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
