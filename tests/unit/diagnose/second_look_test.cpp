#include "hil/diagnose/second_look.h"

#include "hil/model/model.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

// A film that closes its contacts within a hundredth of the range, behind a lag: no law of the library.
double touch(double F) { return F > 0.0 ? 6.0 * (0.12 * (1.0 - std::exp(-F / 0.03)) + 0.88 * std::pow(F / 4.6, 0.9)) + 0.2 : 0.2; }

Diagnosis answer_of_fsr(const Sensor& sensor) {
  Campaign campaign = make_campaign(11, sensor);
  for (Record& r : campaign.records)
    for (double& F : r.trace.find("F_ref")->value) F -= 0.2;  // the ramps go down to no load
  auto out = diagnose_campaign(std::move(campaign), options_of(*library_model("fsr")));
  EXPECT_TRUE(out.has_value()) << (out ? "" : out.error().to_text());
  return out ? *out : Diagnosis{};
}

Sensor film(const std::function<double(double, double)>& volts) {
  return [=](const std::vector<double>& t, const std::vector<double>& F, int) {
    const std::vector<double> y = behind_pole(t, F, 0.06);
    std::vector<double> U;
    for (std::size_t i = 0; i < y.size(); ++i) U.push_back(volts(y[i] - 0.2, t[i]));
    return U;
  };
}

TEST(WholeCurve, OfNoLawOfTheLibraryIsTakenInWholeAndNothingElseIsClaimed) {
  const Diagnosis d = answer_of_fsr(film([](double F, double) { return touch(F); }));
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.9) << told(d);
  for (const Finding& f : d.findings) EXPECT_TRUE(!f.claimed() || f.effect == "static_nonlinearity") << told(d);
  EXPECT_LT(d.error_after, 1.8 * d.floor) << told(d);
}

TEST(WholeCurve, LeavesWhatIsBehindItToBeNamed) {
  const Diagnosis d = answer_of_fsr([](const std::vector<double>& t, const std::vector<double>& F, int) {
    const std::vector<double> y = behind_pole(t, F, 0.06);
    std::vector<double> U;
    double play = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) {
      const double f = y[i] - 0.2;
      play = std::clamp(play, f - 0.15, f + 0.15);
      U.push_back(touch(0.8 * f + 0.2 * std::max(play, 0.0)));
    }
    return U;
  });
  EXPECT_GE(probability(d, "static_nonlinearity"), 0.9) << told(d);
  EXPECT_GE(probability(d, "hysteresis"), 0.5) << told(d);
  EXPECT_LT(probability(d, "dead_zone"), 0.5) << told(d);
  EXPECT_LT(probability(d, "contact_loss"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
