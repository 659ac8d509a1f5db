// Cycles whose frequency changes, of a sensor that loses nothing of its swing.

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kSwitch_s = 50.0;

// Ramps stay as they are; the others go from one frequency to another.
double force_N(double t_s, int record) {
  const double first_Hz = record % 4 == 1 ? 0.4 : 1.6, second_Hz = record % 4 == 1 ? 1.6 : 0.4;
  const double turns = t_s < kSwitch_s ? first_Hz * t_s : first_Hz * kSwitch_s + second_Hz * (t_s - kSwitch_s);
  return 2.2 - 1.6 * std::cos(2.0 * std::numbers::pi * turns);
}

Diagnosis answer_with_bump(double height) {
  Rng rng(3, "reference");
  Campaign c = make_campaign(61, [height](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const bool cycles = record % 2 == 1;
      const double f = cycles ? force_N(t[i], record) : F[i];
      const double bump = cycles && t[i] >= kSwitch_s ? height * std::exp(-(t[i] - kSwitch_s) / 11.0) * (f - 0.6) : 0.0;
      U.push_back(2.0 * (f + bump) + 0.2);
    }
    return U;
  });
  for (std::size_t k = 1; k < c.records.size(); k += 2) {
    Record& r = c.records[k];
    r.kind = "switch";
    std::vector<double>& F = r.trace.find("F_ref")->value;
    for (std::size_t i = 0; i < F.size(); ++i)
      F[i] = std::round((force_N(r.trace.time_bases[0].t_s[i], static_cast<int>(k)) + 0.006 * rng.normal()) / 0.025) * 0.025;
  }
  return answer(std::move(c));
}

TEST(BumpWithoutDecay, IsNamedInRecordsThatSayTheyAreNotDynamic) {
  const Diagnosis d = answer_with_bump(0.04);
  EXPECT_GE(probability(d, "frequency_bump"), 0.9) << told(d);
}

TEST(BumpWithoutDecay, AChangeOfFrequencyAloneIsNone) {
  const Diagnosis d = answer_with_bump(0.0);
  EXPECT_TRUE(std::ranges::none_of(d.findings, &Finding::claimed)) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
