// A contact that opens at the bottom of every cycle, and no angle or command beside it.

#include "hil/diagnose/base/open_contact.h"

#include <numbers>

#include "hil/model/model.h"
#include "tests/unit/diagnose/made_recording.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

using Series = std::vector<double>;

double pressed(double t) { return std::max(0.0, 2.0 - 2.8 * std::cos(2.0 * std::numbers::pi * 0.8 * t)); }

// Open, the amplifier sees no sensor; made again, the arm rings for a while and the film seats anew.
Series ringing(const Series& t, const Series& F) {
  Series U;
  double landed_s = -1.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0 && F[i] > 0.0 && F[i - 1] == 0.0) landed_s = t[i];
    const double since_s = t[i] - landed_s;
    U.push_back(F[i] == 0.0 ? 0.05 : 0.2 + 0.4 * F[i] + 0.12 * std::exp(-since_s / 0.06) * std::cos(2.0 * std::numbers::pi * 11.0 * since_s));
  }
  return U;
}

Series with_loop(const Series&, const Series& F) {
  Series U;
  double play = 0.0;
  for (const double f : F) {
    play = std::clamp(play, f - 0.2, f + 0.2);
    U.push_back(0.2 + 0.35 * f + 0.05 * play);
  }
  return U;
}

TEST(OpenContact, WhatIsSeenOnlyWhileItIsOpenOrJustMadeIsNoLoop) {
  const Diagnosis d = answer(recording(200.0, 18000, pressed, ringing, 0.001));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "contact_loss") << told(d);
  EXPECT_EQ(d.findings.front().side, "rig");
  EXPECT_TRUE(d.findings.front().claimed()) << told(d);
  for (const Finding& f : d.findings) EXPECT_TRUE(f.effect == "contact_loss" || !f.claimed()) << told(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
}

TEST(OpenContact, ALoopIsSeenWhileTheContactIsMade) {
  const Diagnosis d = answer(recording(200.0, 18000, pressed, with_loop, 0.001));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "hysteresis") << told(d);
  EXPECT_TRUE(d.findings.front().claimed()) << told(d);
}

// Its curve is steepest at no load, and is not in the model: what is left without these rows tells nothing of the contact.
TEST(OpenContact, IsNotAskedOfAnFsrWhoseCurveIsMissing) {
  const auto asked = [&](const Model& model) {
    auto out = diagnose_campaign(recording(200.0, 18000, pressed, ringing, 0.001), options_of(model));
    EXPECT_TRUE(out.has_value());
    return out ? *out : Diagnosis{};
  };
  EXPECT_GE(probability(asked(*library_model("flexiforce")), "contact_loss"), 0.5);
  const Diagnosis fsr = asked(*library_model("fsr"));
  EXPECT_LT(probability(fsr, "contact_loss"), 0.4) << told(fsr);
}

// A folder of such files: nothing of what the output does has a name, and all of it lies where the contact is open or was just made.
TEST(OpenContact, IsToldInAFolderToo) {
  Campaign c;
  for (int k = 0; k < 3; ++k) {
    Campaign one = recording(200.0, 9000, [k](double t) { return pressed(t * (1.0 + 0.1 * k)); }, ringing, 0.001);
    one.records.front().name = "r" + std::to_string(k);
    c.records.push_back(std::move(one.records.front()));
  }
  c.name = "folder";
  const Diagnosis d = answer(std::move(c));
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "contact_loss") << told(d);
  EXPECT_TRUE(d.findings.front().claimed()) << told(d);
}

CampaignInput pressing(const std::function<double(double)>& force, double seconds) {
  CampaignInput input;
  input.single = true;
  input.range_N = 4.8;
  RecordInput r;
  for (double t = 0.0; t < seconds; t += 0.02) r.t_s.push_back(t), r.F_N.push_back(force(t));
  input.records.push_back(std::move(r));
  return input;
}

TEST(OpenContact, ItOpensManyTimesAndForAPartOfTheTime) {
  const OpenContact open = open_contact(pressing(pressed, 60.0));
  EXPECT_NEAR(static_cast<double>(open.times), 48.0, 1.0);
  EXPECT_NEAR(open.share, 0.26, 0.03);
  EXPECT_FALSE(open_contact(pressing(pressed, 5.0))) << "a few times";
  EXPECT_FALSE(open_contact(pressing([](double t) { return 2.4 - 2.4 * std::cos(5.0 * t); }, 60.0))) << "it turns there";
  CampaignInput several = pressing(pressed, 60.0);
  several.single = false;
  EXPECT_TRUE(open_contact(several));
  for (int k = 0; k < 2; ++k) several.records.push_back(pressing([](double) { return 2.0; }, 60.0).records.front());
  EXPECT_FALSE(open_contact(several)) << "one of three records";
}

}  // namespace
}  // namespace forcegate::diagnose
