// What is there, and is no finding: an ordinary curve.

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// A curve of `sag` of the span at its middle, and a reference that is fine enough to show it.
Diagnosis of_curved_amplifier(double sag) {
  std::vector<std::vector<double>> exact_N;
  Campaign c = make_campaign(
      91,
      [&](const std::vector<double>&, const std::vector<double>& F, int) {
        exact_N.push_back(F);
        std::vector<double> U;
        for (const double f : F) U.push_back(2.0 * f + 0.2 + 8.8 * sag * 4.0 * f * (4.4 - f) / (4.4 * 4.4));
        return U;
      },
      0.002);
  for (std::size_t k = 0; k < c.records.size(); ++k) c.records[k].trace.find("F_ref")->value = exact_N[k];
  c.bench.reference_resolution_N = 0.001;
  return answer(std::move(c));
}

TEST(Reservation, ACurveThatAnHonestAmplifierHasIsSeenAndNotClaimed) {
  const Diagnosis slight = of_curved_amplifier(0.002), plain = of_curved_amplifier(0.02);
  EXPECT_EQ(slight.verdict, DiagnosisVerdict::none) << told(slight);
  EXPECT_LT(probability(slight, "static_nonlinearity"), 0.5) << told(slight);
  EXPECT_NE(told(slight).find("as bent as that"), std::string::npos) << told(slight);
  EXPECT_GE(probability(plain, "static_nonlinearity"), 0.5) << told(plain);
}

}  // namespace
}  // namespace forcegate::diagnose
