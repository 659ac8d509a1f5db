// Recordings that say little or nothing of the gain: a load that is put on at once and stays, a record in other units, noise.

#include "hil/diagnose/raw/record_gains.h"
#include "hil/diagnose/refit/refit.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kGain_V_per_N = 2.0, kZero_V = 0.1, kPerDecade = 0.04, kRate_Hz = 50.0;

// Ten minutes under 2 N that are put on within a tenth of a second `on_s` after the start; growth per decade from half a second on.
Campaign hold(double on_s, std::uint64_t seed, double noise_V) {
  Campaign c;
  c.name = "hold";
  Record r;
  r.name = "hold";
  TimeBase clock;
  std::vector<double> F, U;
  Rng rng(seed, "hold");
  for (int i = 0; i < static_cast<int>(600.0 * kRate_Hz); ++i) {
    const double t = i / kRate_Hz, load = std::clamp((t - on_s) / 0.1, 0.0, 1.0), since = std::max(0.0, t - on_s);
    const double f = 0.2 + 1.8 * load;
    clock.t_s.push_back(t);
    U.push_back(kGain_V_per_N * (f + 1.8 * load * kPerDecade * std::log10(1.0 + since / 0.5)) + kZero_V + noise_V * rng.normal());
    F.push_back(f + 0.002 * rng.normal());
  }
  r.trace.time_bases.push_back(clock);
  r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
  r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
  c.records.push_back(std::move(r));
  return c;
}

Result<Refit> added(Campaign campaign, const std::string& effect) {
  EngineOptions options;
  options.threads = 1;
  return refit_campaign(std::move(campaign), options, *library_model("flexiforce"), effect);
}

class HoldFromTheStart : public ::testing::TestWithParam<std::pair<double, double>> {};  // load on at, s; noise, V

TEST_P(HoldFromTheStart, TellsGainAndGrowth) {
  const auto [on_s, noise_V] = GetParam();
  const Diagnosis d = answer(hold(on_s, 5, noise_V));
  ASSERT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  ASSERT_EQ(d.findings.front().effect, "creep") << told(d);
  EXPECT_NEAR(d.findings.front().parameters.front().value, kPerDecade, 0.2 * kPerDecade) << told(d);
  const auto refit = added(hold(on_s, 5, noise_V), "creep");
  ASSERT_TRUE(refit) << refit.error().to_text();
  EXPECT_NEAR(refit->model.law.gain_N_per_V, 1.0 / kGain_V_per_N, 0.05 / kGain_V_per_N);
  EXPECT_NEAR(refit->model.law.offset_N, -kZero_V / kGain_V_per_N, 0.04) << "what grows at once is not told from a zero";
  EXPECT_GT(refit->model.se_gain, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Loads, HoldFromTheStart,
                         ::testing::Values(std::pair{0.3, 0.003}, std::pair{2.0, 0.003}, std::pair{5.0, 0.003}, std::pair{30.0, 0.003},
                                           std::pair{5.0, 0.006}));

TEST(NoGain, AnOutputThatDoesNotFollowTheForceIsNeitherCleanNorFitted) {
  const auto noise = [] {
    return make_campaign(14, [](const std::vector<double>&, const std::vector<double>& F, int k) {
      Rng rng(static_cast<std::uint64_t>(k), "noise");
      std::vector<double> U(F.size());
      for (double& u : U) u = 4.0 + 0.5 * rng.normal();
      return U;
    });
  };
  EXPECT_NE(answer(noise()).verdict, DiagnosisVerdict::none);
  const auto refit = added(noise(), "");
  ASSERT_FALSE(refit);
  EXPECT_NE(refit.error().text.find("gain"), std::string::npos) << refit.error().to_text();
}

TEST(RecordGains, ARecordInOtherUnitsIsNamed) {
  Campaign c = make_campaign(15, straight);
  for (double& u : c.records[2].trace.channels[1].value) u *= 1000.0;
  EngineOptions options;
  options.threads = 1;
  const auto d = diagnose_campaign(std::move(c), options);
  ASSERT_FALSE(d);
  EXPECT_NE(d.error().where.find("r2"), std::string::npos) << d.error().to_text();
}

/// A hundred rows along a line, steps in newtons and volts.
RecordInput line(const std::string& name, double step_N, double step_V) {
  RecordInput r;
  r.name = name;
  for (int i = 0; i < 100; ++i) {
    r.t_s.push_back(0.02 * i);
    r.F_N.push_back(2.0 + step_N * i);
    r.U_V.push_back(4.0 + step_V * i);
    r.ok.push_back(1);
  }
  return r;
}

TEST(RecordGains, AnotherAmplifierIsANoteAndADecayIsNone) {
  std::vector<RecordInput> records = {line("a", 0.05, 0.1), line("b", 0.05, 0.1), line("c", 0.05, 0.02)};  // a decay leaves a fifth
  std::vector<std::string> notes;
  ASSERT_TRUE(check_record_gains(records, notes));
  EXPECT_TRUE(notes.empty());
  for (double& u : records[1].U_V) u *= 10.0;
  ASSERT_TRUE(check_record_gains(records, notes));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes.front(), "b: the output per newton is 10 times that of most other records");
}

TEST(RecordGains, ARecordWithTheOtherSignIsAnErrorAndAHoldThatCreepsDownIsNone) {
  std::vector<RecordInput> records = {line("a", 0.05, 0.1), line("b", 0.05, 0.1), line("hold", 1e-4, -1e-4)};
  std::vector<std::string> notes;
  EXPECT_TRUE(check_record_gains(records, notes));
  for (double& F : records[1].F_N) F = -F;
  const auto refused = check_record_gains(records, notes);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "b");
  EXPECT_NE(refused.error().text.find("falls where the force rises"), std::string::npos) << refused.error().to_text();
  for (double& F : records[0].F_N) F = -F;
  EXPECT_TRUE(check_record_gains(records, notes)) << "a sensor whose output falls with the load";
}

TEST(RecordGains, OfTwoRecordsBothAreNamed) {
  std::vector<RecordInput> records = {line("first", 0.05, 0.01), line("second", 0.05, 0.1)};
  std::vector<std::string> notes;
  ASSERT_TRUE(check_record_gains(records, notes));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes.front(), "second: the output per newton is 10 times that of first");
  for (double& u : records[1].U_V) u *= 100.0;
  const auto refused = check_record_gains(records, notes);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().to_text().find("first"), std::string::npos);
  EXPECT_NE(refused.error().to_text().find("second"), std::string::npos);
}

}  // namespace
}  // namespace forcegate::diagnose
