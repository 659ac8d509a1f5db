// When levels are no witness of a creep. That they are one of a creep that runs on is tested on mysteries (tests/system/diagnose_test.cpp).

#include "hil/diagnose/between/outlasting.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

constexpr double kTau_s = 1800.0, kRest_s = 780.0;

// A spring and a damper behind the film, in Heun steps; between the records it rests without load.
Campaign creeping(std::uint64_t seed, double share, bool forgets) {
  double z = 0.0;
  Campaign c = make_campaign(seed, [&](const std::vector<double>& t, const std::vector<double>& F, int record) {
    z = forgets || record == 0 ? 0.0 : z * std::exp(-kRest_s / kTau_s);
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double h = i == 0 ? 0.0 : (t[i] - t[i - 1]) / kTau_s, before = i == 0 ? F[0] : F[i - 1];
      const double first = before - z;
      z += 0.5 * h * (first + F[i] - (z + h * first));
      U.push_back(2.0 * (F[i] + share * z) + 0.2);
    }
    return U;
  });
  for (Record& r : c.records) r.role = RecordRole::fit;
  return c;
}

// The levels scatter by as much without a creep, or the rows creep and the levels do not go with it: no witness agrees with another.
TEST(Outlasting, LevelsThatScatterAreNoCreep) {
  Campaign c = make_campaign(52, straight);
  constexpr double kZero_V[] = {0.05, -0.07, 0.02, 0.09, -0.04, -0.08, 0.06, 0.01};
  for (std::size_t k = 0; k < c.records.size(); ++k)
    for (double& u : c.records[k].trace.find("U")->value) u += kZero_V[k];
  EXPECT_LT(probability(answer(c), "creep"), 0.5);
}

TEST(Outlasting, AFormThatOutlastsARecordIsNotAskedOfRowsAlone) {
  const Diagnosis d = answer(creeping(53, 0.4, true));
  for (const Finding& f : d.findings)
    if (f.effect == "creep") {
      EXPECT_NE(f.form, "carried") << told(d);
    }
}

}  // namespace
}  // namespace forcegate::diagnose
