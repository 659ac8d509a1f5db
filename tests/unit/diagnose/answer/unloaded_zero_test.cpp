#include "hil/diagnose/answer/unloaded_zero.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

double by_turns(int k) { return k % 4 == 0 ? 1.0 : k % 4 == 1 ? -0.7 : k % 4 == 2 ? 0.3 : -1.2; }

// Eight records that begin and end without load; the zero of the reference and that of the output are what they are in each.
Diagnosis answer_to(const std::function<double(int)>& reference_N, const std::function<double(int)>& output_V, const std::function<double(int)>& lowest_N = [](int) { return 0.0; }) {
  Campaign campaign = make_campaign(11, [&](const std::vector<double>& t, const std::vector<double>& F, int k) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const bool rests = t[i] < 8.0 || t[i] > 112.0;
      U.push_back(0.5 + 1.6 * (rests ? lowest_N(k) : std::max(lowest_N(k), F[i])) + output_V(k));
    }
    return U;
  });
  for (std::size_t k = 0; k < campaign.records.size(); ++k) {
    Record& r = campaign.records[k];
    std::vector<double>& F = r.trace.find("F_ref")->value;
    const double low = lowest_N(static_cast<int>(k));
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double t = r.trace.time_bases.front().t_s[i];
      F[i] = (t < 8.0 || t > 112.0 ? low : std::max(low, F[i])) + reference_N(static_cast<int>(k));
    }
    r.start_s.reset();
  }
  return answer(std::move(campaign));
}

const Finding* drift_of(const Diagnosis& d) {
  const auto found = std::ranges::find(d.findings, "reference_drift", &Finding::effect);
  return found == d.findings.end() || !found->claimed() ? nullptr : &*found;
}

TEST(UnloadedZero, AReferenceThatShowsAnotherForceWithoutLoadInEveryRecordDrifts) {
  const Diagnosis d = answer_to([](int k) { return 0.2 * by_turns(k); }, [](int) { return 0.0; });
  const Finding* drift = drift_of(d);
  ASSERT_NE(drift, nullptr) << told(d);
  EXPECT_EQ(drift->side, "reference");
  ASSERT_EQ(drift->parameters.size(), 1u);
  EXPECT_NEAR(drift->parameters.front().value, 0.2 * 0.93, 0.03);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
  for (const std::string& note : d.notes) EXPECT_EQ(note.find("zero scatters"), std::string::npos) << note;
}

TEST(UnloadedZero, AZeroOfTheOutputMovesTheOutput) {
  const Diagnosis d = answer_to([](int) { return 0.0; }, [](int k) { return 0.32 * by_turns(k); });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

TEST(UnloadedZero, RecordsThatKeepALoadOfTheirOwnDoNotTell) {
  const Diagnosis d = answer_to([](int k) { return 0.2 * by_turns(k); }, [](int) { return 0.0; }, [](int k) { return 0.15 * (k % 3) + 0.12 * k; });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

TEST(UnloadedZero, WhatBenchesScatterByIsNoDrift) {
  const Diagnosis d = answer_to([](int k) { return 0.012 * by_turns(k); }, [](int) { return 0.0; });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
