#include "hil/diagnose/laws/drift.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

Campaign recording(std::size_t n, double step_s, double noise, const std::function<double(double)>& law) {
  Campaign campaign;
  campaign.name = "drift";
  Record record;
  record.name = "r1";
  record.trace.time_bases.push_back({"rig", {}, 0.0, {}, false});
  Channel U{"U", "V", "voltage", 0, {}, {}};
  Rng rng(3, "drift");
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) * step_s;
    record.trace.time_bases[0].t_s.push_back(t);
    U.value.push_back(law(t) + noise * rng.normal());
  }
  record.trace.channels.push_back(std::move(U));
  campaign.records.push_back(std::move(record));
  return campaign;
}

std::string form_of(const Campaign& campaign) {
  const auto d = diagnose_drift(campaign);
  EXPECT_TRUE(d) << (d ? "" : d.error().to_text());
  if (!d || d->findings.empty()) return "(none)";
  EXPECT_EQ(d->findings.front().effect, "drift");
  EXPECT_LT(d->error_after, d->error_before);
  return d->findings.front().form;
}

TEST(Drift, TellsOneTimeConstantFromTheLogarithmAndThePower) {
  EXPECT_EQ(form_of(recording(1500, 0.1, 0.002, [](double t) { return 3.0 + 0.8 * std::exp(-t / 40.0); })),
            "exponential");
  EXPECT_EQ(
      form_of(recording(1500, 0.1, 0.002, [](double t) { return 3.0 - 0.2 * std::log10(1.0 + t / 0.5); })),
      "logarithm");
  EXPECT_EQ(form_of(recording(1500, 0.1, 0.002, [](double t) { return 3.0 + 0.02 * std::pow(t, 0.6); })),
            "power");
  EXPECT_EQ(form_of(recording(1500, 0.1, 0.002, [](double t) { return 3.0 + 0.01 * t; })), "line");
}

TEST(Drift, ARiseIsPositiveUnderEveryLaw) {
  for (const double sign : {1.0, -1.0}) {
    const auto size_of = [&](const std::function<double(double)>& law) {
      const auto d = diagnose_drift(recording(1500, 0.1, 0.002, [&](double t) { return 3.0 + sign * law(t); }));
      return d && !d->findings.empty() ? sign * d->findings.front().parameters.front().value : 0.0;
    };
    EXPECT_NEAR(size_of([](double t) { return 0.8 * (1.0 - std::exp(-t / 40.0)); }), 0.8, 0.01);
    EXPECT_NEAR(size_of([](double t) { return 0.01 * t; }), 0.01, 1e-4);
    EXPECT_GT(size_of([](double t) { return 0.2 * std::log10(1.0 + t / 0.5); }), 0.1);
    EXPECT_GT(size_of([](double t) { return 0.02 * std::pow(t, 0.6); }), 0.01);
  }
  const auto d = diagnose_drift(recording(1500, 0.1, 0.002, [](double t) { return 3.0 + 0.8 * (1.0 - std::exp(-t / 40.0)); }));
  ASSERT_TRUE(d);
  EXPECT_NE(d->findings.front().evidence.find("towards 3.8"), std::string::npos) << d->findings.front().evidence;
}

TEST(Drift, SaysThatItsErrorsAreThoseOfMeans) {
  const auto d = diagnose_drift(recording(20000, 0.1, 0.001, [](double t) { return 3.0 + 0.8 * std::exp(-t / 400.0); }));
  ASSERT_TRUE(d);
  EXPECT_EQ(d->judged_by, JudgedBy::left_out);
  EXPECT_LT(d->error_after, 0.0003);
  const std::string says = "errors and floor are of 200 means of each record, over 10 s; single samples scatter by ";
  const auto told = std::find_if(d->notes.begin(), d->notes.end(), [&](const std::string& note) { return note.starts_with(says); });
  ASSERT_NE(told, d->notes.end());
  EXPECT_NEAR(std::stod(told->substr(says.size())), 1.0, 0.03) << *told;  // mV
}

// A law that takes nearly all of the movement and leaves a hundred times the noise is not all there is.
TEST(Drift, SaysWhatALawLeaves) {
  const auto with = [](double wave) {
    return diagnose_drift(recording(1500, 0.1, 0.0005, [=](double t) { return 3.0 + 2.0 * std::exp(-t / 40.0) + wave * std::sin(0.5 * t); }));
  };
  const auto pure = with(0.0), more = with(0.05);
  ASSERT_TRUE(pure && more);
  EXPECT_EQ(more->verdict, DiagnosisVerdict::known);
  EXPECT_TRUE(more->residual_unknown);
  EXPECT_EQ(more->depends_on, std::vector<std::string>{"time"});
  EXPECT_FALSE(pure->residual_unknown);
}

TEST(Drift, FindsTheTimeConstantAndWhereItSetsIn) {
  const auto d = diagnose_drift(recording(
      1500, 0.1, 0.002, [](double t) { return 0.2 + 3.5 * std::exp(-std::max(0.0, t - 8.0) / 22.0); }));
  ASSERT_TRUE(d);
  ASSERT_EQ(d->findings.size(), 1u);
  double tau_s = 0.0, onset_s = 0.0;
  for (const FoundParameter& p : d->findings[0].parameters) {
    if (p.name == "tau_s") tau_s = p.value;
    if (p.name == "onset_s") onset_s = p.value;
  }
  EXPECT_NEAR(tau_s, 22.0, 0.5);
  EXPECT_NEAR(onset_s, 8.0, 0.5);
  EXPECT_FALSE(d->findings[0].side_witnessed);
  EXPECT_EQ(d->findings[0].side, "unknown");
  ASSERT_EQ(d->records.size(), 1u);
  EXPECT_EQ(d->records[0].record, "r1");
  EXPECT_NEAR(d->records[0].after, d->error_after, 1e-12);
}

TEST(Drift, NoiseAloneIsNoDrift) {
  for (const double noise : {0.001, 0.1}) {
    const auto d = diagnose_drift(recording(1000, 0.1, noise, [](double) { return 2.0; }));
    ASSERT_TRUE(d);
    EXPECT_EQ(d->verdict, DiagnosisVerdict::none);
    EXPECT_TRUE(d->findings.empty());
  }
}

TEST(Drift, AnOutputThatFollowsSomethingUnrecordedIsUnknown) {
  Campaign campaign = recording(6000, 0.01, 0.002, [](double t) { return 3.0 + std::sin(3.0 * t); });
  campaign.records[0].trace.channels.push_back(
      {"load", "", "", 0, campaign.records[0].trace.channels[0].value, {}});
  const auto d = diagnose_drift(campaign);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->verdict, DiagnosisVerdict::unknown);
  bool told = false;
  for (const std::string& note : d->notes) told |= note.find("--map load=F_ref_N") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST(Drift, AForceThatStandsStillIsNoInput) {
  Campaign campaign = recording(100, 0.1, 0.0, [](double t) { return t; });
  EXPECT_TRUE(is_drift_only(campaign));
  campaign.records[0].trace.channels.push_back({"F_ref", "N", "force", 0, std::vector<double>(100, 2.0), {}});
  EXPECT_TRUE(is_drift_only(campaign));
  campaign.records[0].trace.channels.back().value[50] = 2.5;
  EXPECT_FALSE(is_drift_only(campaign));
}

TEST(Drift, CreepThatIsNearlyOverWithinTheFirstMeanKeepsItsLaw) {
  const Campaign hold = recording(30000, 0.02, 0.004, [](double t) { return 3.9 + 0.12 * std::log10(1.0 + t); });
  EXPECT_EQ(form_of(hold), "logarithm");
  const auto d = diagnose_drift(hold);
  ASSERT_TRUE(d);
  EXPECT_NEAR(d->findings.front().parameters.front().value, 0.12, 0.002);
}

TEST(Drift, AWanderFarAboveItsNoiseIsNoSteadyDrift) {
  Rng steps(9, "walk");
  double at = 0.0;
  const auto walk = diagnose_drift(recording(30000, 0.02, 0.004, [&](double) { return 3.9 + (at += 0.001 * steps.normal()); }));
  ASSERT_TRUE(walk);
  EXPECT_EQ(walk->verdict, DiagnosisVerdict::unknown);
  EXPECT_EQ(walk->depends_on, std::vector<std::string>{"time"});
  const auto daily = diagnose_drift(recording(30000, 0.02, 0.02, [](double t) { return 3.9 + 0.02 * std::sin(t / 40.0); }));
  ASSERT_TRUE(daily);
  EXPECT_EQ(daily->verdict, DiagnosisVerdict::unknown);
}

TEST(Drift, TwoOutputsMustBeTold) {
  Campaign campaign = recording(100, 0.1, 0.0, [](double t) { return t; });
  campaign.records[0].trace.channels[0].name = "a";
  campaign.records[0].trace.channels.push_back(campaign.records[0].trace.channels[0]);
  campaign.records[0].trace.channels[1].name = "b";
  const auto d = diagnose_drift(campaign);
  ASSERT_FALSE(d);
  EXPECT_NE(d.error().text.find("a_V, b_V"), std::string::npos);
}

TEST(Drift, ItsUncertaintyIsThatOfTheSlopeAndNotOfTheNoise) {
  const auto d = diagnose_drift(recording(1500, 0.1, 0.002, [](double t) { return 3.0 + 0.01 * t; }));
  ASSERT_TRUE(d);
  const FoundParameter& slope = d->findings.front().parameters.front();
  EXPECT_NEAR(slope.value, 0.01, 4.0 * slope.u);
  EXPECT_GT(slope.u, 1e-7);
  EXPECT_LT(slope.u, 2e-5);  // 1.2e-6 of white noise by theory
}

TEST(Drift, SaysThatNoColumnIsAForceAndGivesNoNumberToALawThatFails) {
  // waves without an input: an exponential fitted to a part of them runs away on the next
  const auto d = diagnose_drift(recording(4000, 0.05, 0.002, [](double t) { return 2.0 + std::sin(0.5 * t) + 0.4 * std::sin(0.05 * t); }));
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_EQ(d->notes.front(), "no column is the reference force, among U_V: only the drift of the output can be judged");
  EXPECT_NE(to_json(*d).find("\"adapted\": [],"), std::string::npos) << "no gain, zero or decay of a record";
  for (const std::string& note : d->notes) {
    const std::size_t at = note.find(" V on parts");
    if (at != std::string::npos) {
      EXPECT_LT(std::stod(note.substr(note.find(": ") + 2)), 30.0) << note;
    }
  }
  Campaign still = recording(400, 0.05, 0.002, [](double) { return 2.0; });
  still.records.front().trace.channels.push_back({"F_ref", "N", "force", 0, std::vector<double>(400, 1.0), {}});
  const auto of_still = diagnose_drift(still);
  ASSERT_TRUE(of_still);
  EXPECT_EQ(of_still->notes.front(), "no record has an input that moves: only the drift of the output can be judged");
}

// A straight line is no power of the time below 0.9.
TEST(Drift, AShapeStaysWithinItsBounds) {
  const Campaign campaign = recording(4000, 0.1, 1e-4, [](double t) { return 1.0 + 0.01 * t; });
  const auto fitted = fit_drift("line", campaign.records[0].trace.time_bases[0].t_s, campaign.records[0].trace.channels[0].value);
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  for (const DriftFit& fit : fitted->fits) {
    if (fit.law->shape_low == nullptr) continue;
    EXPECT_GE(fit.shape, fit.law->shape_low(400.0) * 0.99) << fit.law->name;
    EXPECT_LE(fit.shape, fit.law->shape_high(400.0) * 1.01) << fit.law->name;
  }
}

// The next refusal of a longer one with a force must be no news.
TEST(Drift, ATooShortRecordingIsToldWhatADiagnosisAsksFor) {
  const auto d = diagnose_drift(recording(10, 0.1, 0.001, [](double t) { return t; }));
  ASSERT_FALSE(d);
  EXPECT_NE(d.error().hint.find("at least 40 are needed"), std::string::npos) << d.error().to_text();
  EXPECT_NE(d.error().hint.find("200 of a recording with a force"), std::string::npos) << d.error().to_text();
}

}  // namespace
}  // namespace forcegate::diagnose
