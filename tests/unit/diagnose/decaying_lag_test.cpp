// Cycles of a film that is late and whose swing decays: what is late decays with it.

#include <cmath>

#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/refit/refit.h"
#include "hil/model/model.h"
#include "tests/unit/diagnose/behind_pole.h"
#include "tests/unit/diagnose/made_campaign.h"
#include "tests/unit/diagnose/options_of_model.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 25.0, kLag_s = 0.055, kGain_V_per_N = 1.7;

// Ten minutes of a sine each, all about one mean and with one amplitude: nothing but the cycles tells of the gain. From record to record the loss
// grows by `spread` of itself.
Campaign cycles(double loss, double spread = 0.0) {
  Campaign c;
  c.name = "cycles";
  c.bench.voltage_min_V = 0.0;
  c.bench.voltage_max_V = 10.0;
  int k = 0;
  for (const double f_Hz : {0.05, 0.5, 1.0}) {
    Rng rng(static_cast<std::uint64_t>(++k), "cycles");
    Record r;
    r.name = "run" + std::to_string(k);
    r.start_s = 10000.0 * k;
    r.dynamic = true;
    TimeBase clock;
    std::vector<double> F;
    for (int i = 0; i < static_cast<int>(600.0 * kRate_Hz); ++i) {
      const double t = i / kRate_Hz;
      clock.t_s.push_back(t);
      F.push_back(2.1 - 1.43 * std::cos(2.0 * 3.14159265358979 * f_Hz * t));
    }
    const std::vector<double> late = behind_pole(clock.t_s, F, kLag_s);
    const double gain = kGain_V_per_N * (1.0 + 0.01 * rng.normal()), zero = 0.2 + 0.01 * rng.normal();
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double t = clock.t_s[i], D = 1.0 - loss * (1.0 + spread * (k - 2)) * (0.6 * -std::expm1(-t / 400.0) + 0.4 * -std::expm1(-t / 2500.0)) / 0.55;
      U.push_back(gain * (0.67 + D * (late[i] - 0.67)) + zero + 0.008 * rng.normal());
      F[i] += 0.003 * rng.normal();
    }
    r.trace.time_bases.push_back(clock);
    r.trace.channels.push_back({"F_ref", "N", "force", 0, F, {}});
    r.trace.channels.push_back({"U", "V", "voltage", 0, U, {}});
    c.records.push_back(std::move(r));
  }
  return c;
}

EngineOptions of_fsr() { return options_of(*library_model("fsr")); }

TEST(DecayingLag, OfCyclesOfOneLowestForceNothingIsMissing) {
  const auto d = diagnose_campaign(cycles(0.16), of_fsr());
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_EQ(d->verdict, DiagnosisVerdict::none) << told(*d);
  EXPECT_LT(d->error_after, 1.5 * d->floor);
}

TEST(DecayingLag, TheGainOfCyclesOfOneLowestForceIsFitted) {
  const auto fitted = refit_campaign(cycles(0.16), of_fsr(), *library_model("fsr"), "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  EXPECT_NEAR(1.0 / fitted->model.law.gain_N_per_V, kGain_V_per_N, 0.05 * kGain_V_per_N);
}

// The spreads of a law that lacks its lag are those of its errors: by them no record followed its own decay.
TEST(DecayingLag, AFitIsJudgedAsTheDiagnosisOfItsModel) {
  const auto fitted = refit_campaign(cycles(0.16, 0.5), of_fsr(), *library_model("fsr"), "");
  ASSERT_TRUE(fitted) << fitted.error().to_text();
  const auto d = diagnose_campaign(cycles(0.16, 0.5), options_of(fitted->model));
  ASSERT_TRUE(d) << d.error().to_text();
  EXPECT_NEAR(fitted->error_after, d->error_before, 0.1 * d->error_before);
  EXPECT_GT(fitted->error_before, 5.0 * fitted->error_after);
}

// Edges hide a small decay from the columns of lag; where the other record decays plainly it is one.
TEST(OwnDecay, ASmallDecayCountsBesideOthers) {
  OwnDecay own;
  own.static_mean_square = 1.0;
  own.mean_square = 0.8;
  own.depth = 0.1;
  EXPECT_FALSE(own.is_decay());
  EXPECT_TRUE(own.is_decay(true));
  own.depth = 0.004;
  EXPECT_FALSE(own.is_decay(true));
  own.mean_square = 0.3;
  own.depth = 0.04;
  EXPECT_TRUE(own.is_decay());
}

}  // namespace
}  // namespace forcegate::diagnose
