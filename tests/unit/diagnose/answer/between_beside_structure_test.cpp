// What acts between records is asked for the error of one gain and zero for all: what is left within the records is another matter.

#include <array>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Mounted anew twice: the gain is another each time, and so is a slight curve.
std::vector<double> mounted_anew(const std::vector<double>&, const std::vector<double>& F, int record) {
  constexpr std::array<double, 3> kGain = {1.0, 1.14, 0.9}, kCurve = {0.012, -0.014, 0.01};
  const std::size_t mounting = record < 3 ? 0 : record < 6 ? 1 : 2;
  std::vector<double> U;
  for (const double f : F) U.push_back(2.0 * kGain[mounting] * (f + kCurve[mounting] * (f - 2.2) * (f - 2.2)) + 0.4);
  return U;
}

TEST(BetweenBesideStructure, MountingsThatDifferIsClaimedThoughEachBendsALittle) {
  Campaign c = make_campaign(17, mounted_anew);
  for (std::size_t k = 0; k < c.records.size(); ++k) c.records[k].mounting = k < 3 ? "1" : k < 6 ? "2" : "3";
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known) << told(d);
  EXPECT_GT(probability(d, "mounting"), 0.8) << told(d);
  EXPECT_LT(d.error_after, 0.3 * d.error_before);
}

}  // namespace
}  // namespace forcegate::diagnose
