// A zero that settles with the time, whatever the load, beside creep.

#include <cmath>

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 50.0;
constexpr std::size_t kSamples = 30000;  // 600 s

double settles(double t_s) { return -0.2 * std::expm1(-t_s / 150.0); }

double cycles(double t_s) { return 2.5 - 2.0 * std::cos(3.14159265 * t_s); }

// Loads of 1 to 5 N for 30 s, and 20 s without.
double holds(double t_s) {
  const int k = static_cast<int>(t_s / 50.0);
  const double in_s = t_s - 50.0 * k, load_N = 1.0 + k * 7 % 5;
  return load_N * std::clamp(std::min(in_s - 9.0, 41.0 - in_s), 0.0, 1.0);
}

// Growth by `share` of the load with poles from 3 to 300 s.
std::vector<double> creeps(const std::vector<double>& F, double share) {
  std::vector<double> out(F.size(), 0.0);
  for (const double tau_s : {3.0, 10.0, 30.0, 100.0, 300.0}) {
    double state = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      state += (F[i] - state) * -std::expm1(-1.0 / (kRate_Hz * tau_s));
      out[i] += share / 5.0 * state;
    }
  }
  return out;
}

Diagnosis answer_to(const std::function<double(double)>& load_N, bool zero_settles, double creep) {
  Campaign campaign = recording(
      kRate_Hz, kSamples, load_N,
      [&](const std::vector<double>& t, const std::vector<double>& F) {
        const std::vector<double> grown = creeps(F, creep);
        std::vector<double> U;
        for (std::size_t i = 0; i < F.size(); ++i) U.push_back(0.05 + 0.4 * (F[i] + grown[i] + (zero_settles ? settles(t[i]) : 0.0)));
        return U;
      },
      0.004);
  campaign.records.front().dynamic = false;
  return answer(std::move(campaign));
}

const Finding* creep_of(const Diagnosis& d) {
  const auto found = std::ranges::find(d.findings, "creep", &Finding::effect);
  return found == d.findings.end() ? nullptr : &*found;
}

bool says(const Diagnosis& d, const char* what) {
  return std::ranges::any_of(d.notes, [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

TEST(SettlingZero, UnderOneLoadThatGoesOnItIsNotToldFromCreep) {
  const Diagnosis d = answer_to(cycles, true, 0.0);
  ASSERT_NE(creep_of(d), nullptr) << told(d);
  EXPECT_LE(creep_of(d)->probability, 0.7);
  EXPECT_TRUE(says(d, "a zero that settles with the time, whatever the load, look the same under this load")) << told(d);
}

TEST(SettlingZero, BetweenLoadsThatComeAndGoItIsNoCreep) {
  const Diagnosis d = answer_to(holds, true, 0.0);
  EXPECT_FALSE(creep_of(d) != nullptr && creep_of(d)->claimed()) << told(d);
  EXPECT_EQ(d.verdict, DiagnosisVerdict::unknown);
  EXPECT_TRUE(says(d, "a zero that settles with the time")) << told(d);
}

TEST(SettlingZero, CreepUnderLoadsThatComeAndGoIsSure) {
  const Diagnosis d = answer_to(holds, false, 0.12);
  ASSERT_NE(creep_of(d), nullptr) << told(d);
  EXPECT_GT(creep_of(d)->probability, 0.9);
  EXPECT_FALSE(says(d, "a zero that settles with the time")) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
