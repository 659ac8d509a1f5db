#include "hil/diagnose/between/unloaded_zero.h"

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

double by_turns(int k) { return k % 4 == 0 ? 1.0 : k % 4 == 1 ? -0.7 : k % 4 == 2 ? 0.3 : -1.2; }

// Eight records that begin and end without load; the zero of the reference and that of the output are what they are in each.
Campaign campaign_of(const std::function<double(int)>& reference_N, const std::function<double(int)>& output_V, const std::function<double(int)>& lowest_N = [](int) { return 0.0; }) {
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
  return campaign;
}

Diagnosis answer_to(const std::function<double(int)>& reference_N, const std::function<double(int)>& output_V, const std::function<double(int)>& lowest_N = [](int) { return 0.0; }) {
  return answer(campaign_of(reference_N, output_V, lowest_N));
}

// The same, and the air has a temperature in each.
Diagnosis answer_in_air(const std::function<double(int)>& reference_N, const std::function<double(int)>& output_V, const std::function<double(int)>& air_C) {
  Campaign campaign = campaign_of(reference_N, output_V, [](int) { return 0.0; });
  for (std::size_t k = 0; k < campaign.records.size(); ++k) {
    Trace& trace = campaign.records[k].trace;
    trace.channels.push_back({"temp", "C", "temperature", 0, std::vector<double>(trace.time_bases[0].t_s.size(), air_C(static_cast<int>(k))), {}});
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
  // its picture: the zeros as they were put in, and nothing of them once they are taken off
  ASSERT_EQ(drift->series.size(), 1u);
  const EvidenceSeries& zeros = drift->series.front();
  EXPECT_EQ(zeros.x_name, "record");
  ASSERT_GE(zeros.x.size(), 4u);
  for (std::size_t i = 0; i < zeros.x.size(); ++i) {
    EXPECT_NEAR(zeros.before[i], 0.2 * by_turns(static_cast<int>(zeros.x[i]) - 1), 0.06) << zeros.x[i];
    EXPECT_NEAR(zeros.after[i], 0.0, 0.06) << zeros.x[i];
  }
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
  for (const std::string& note : d.notes) EXPECT_EQ(note.find("zero scatters"), std::string::npos) << note;
}

TEST(UnloadedZero, AZeroOfTheOutputMovesTheOutput) {
  const Diagnosis d = answer_to([](int) { return 0.0; }, [](int k) { return 0.32 * by_turns(k); });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

TEST(UnloadedZero, AReferenceThatFollowsTheTemperatureIsNoTemperatureOfTheSensor) {
  const auto air_C = [](int k) { return 22.0 + 3.0 * by_turns(k) + 0.3 * k; };
  const Diagnosis d = answer_in_air([&](int k) { return 0.05 * (air_C(k) - 22.0); }, [](int) { return 0.0; }, air_C);
  ASSERT_NE(drift_of(d), nullptr) << told(d);
  EXPECT_EQ(drift_of(d)->side, "reference");
  for (const Finding& f : d.findings) EXPECT_FALSE(f.claimed() && f.side == "sensor") << f.effect;
}

TEST(UnloadedZero, AZeroOfTheSensorThatFollowsTheTemperatureIsItsOwn) {
  const auto air_C = [](int k) { return 22.0 + 3.0 * by_turns(k) + 0.3 * k; };
  const Diagnosis d = answer_in_air([](int) { return 0.0; }, [&](int k) { return -0.08 * (air_C(k) - 22.0); }, air_C);
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "thermal") << told(d);
  EXPECT_TRUE(d.findings.front().claimed()) << told(d);
}

TEST(UnloadedZero, RecordsThatKeepALoadOfTheirOwnDoNotTell) {
  const Diagnosis d = answer_to([](int k) { return 0.2 * by_turns(k); }, [](int) { return 0.0; }, [](int k) { return 0.15 * (k % 3) + 0.12 * k; });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

// A press that never lets go: its lowest loads are nobody's zero, and records of another gain agree there by chance.
TEST(UnloadedZero, LoadsFarFromZeroMustAgreeMoreClosely) {
  const auto answer_about = [](double scatter_N) {
    return answer_to([](int k) { return 0.2 * by_turns(k); }, [](int) { return 0.0; }, [=](int k) { return 2.0 + scatter_N * by_turns(k + 1); });
  };
  EXPECT_NE(drift_of(answer_about(0.0)), nullptr);
  EXPECT_EQ(drift_of(answer_about(0.045)), nullptr);
}

TEST(UnloadedZero, WhatBenchesScatterByIsNoDrift) {
  const Diagnosis d = answer_to([](int k) { return 0.012 * by_turns(k); }, [](int) { return 0.0; });
  EXPECT_EQ(drift_of(d), nullptr) << told(d);
}

// One recording of a press that lets go every 20 s; a zero creeps up by 0.15 N.
Diagnosis answer_to_cycles(bool of_reference) {
  const auto load_N = [](double t) { return std::max(0.0, 5.0 * (0.5 - 0.5 * std::cos(0.314159 * t)) * (0.6 + 0.4 * std::sin(0.037 * t)) - 0.3); };
  const auto zero_N = [](double t) { return -0.15 * std::expm1(-t / 200.0); };
  Campaign campaign = recording(
      50.0, 30000, load_N,
      [&](const std::vector<double>& t, const std::vector<double>& F) {
        std::vector<double> U;
        for (std::size_t i = 0; i < F.size(); ++i) U.push_back(0.05 + 0.4 * (F[i] + (of_reference ? 0.0 : zero_N(t[i]))));
        return U;
      },
      0.002);
  Trace& trace = campaign.records.front().trace;
  Rng rng(7, "reference");
  for (std::size_t i = 0; i < trace.time_bases[0].t_s.size(); ++i)
    trace.find("F_ref")->value[i] += 0.01 * rng.normal() + (of_reference ? zero_N(trace.time_bases[0].t_s[i]) : 0.0);
  return answer(std::move(campaign));
}

TEST(UnloadedZero, OneRecordingOfManyLoadsTellsWhoseZeroMoves) {
  const Diagnosis d = answer_to_cycles(true);
  ASSERT_NE(drift_of(d), nullptr) << told(d);
  EXPECT_EQ(drift_of(d)->side, "reference");
  ASSERT_EQ(drift_of(d)->series.size(), 1u);
  const EvidenceSeries& zeros = drift_of(d)->series.front();
  EXPECT_EQ(zeros.x_unit, "s");
  EXPECT_GT(zeros.x.back(), 450.0);  // of the recording, not of a part of it
  for (std::size_t i = 1; i < zeros.x.size(); ++i) EXPECT_GT(zeros.x[i], zeros.x[i - 1] + 10.0) << "each where it was recorded";
  EXPECT_GT(zeros.before.back() - zeros.before.front(), 0.08);
  for (const Finding& f : d.findings) EXPECT_FALSE(f.claimed() && f.side == "sensor") << f.effect;
}

TEST(UnloadedZero, OneRecordingInWhichTheOutputMovesWithoutLoadHasNoDriftOfTheReference) { EXPECT_EQ(drift_of(answer_to_cycles(false)), nullptr); }

}  // namespace
}  // namespace forcegate::diagnose
