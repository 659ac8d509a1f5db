#include "hil/diagnose/choose/hold_growth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "hil/base/rng.h"

namespace forcegate::diagnose {
namespace {

// Three records that climb and come down in steps of 20 s; 50 rows a second.
CampaignInput stairs(const std::function<std::vector<double>(const std::vector<double>& F_N)>& output_N) {
  CampaignInput c;
  c.range_N = 4.0;
  for (int k = 0; k < 3; ++k) {
    Rng rng(k + 1, "stairs");
    RecordInput r;
    std::vector<double> F;
    for (int i = 0; i < 8000; ++i) {
      const int step = i / 1000;
      F.push_back(static_cast<double>(step < 4 ? step + 1 : 7 - step) * 0.9);
      r.t_s.push_back(0.02 * i);
    }
    for (const double f : output_N(F)) r.U_V.push_back(2.0 * f + 0.1 * k + 0.004 * rng.normal());
    for (const double f : F) r.F_N.push_back(f + 0.002 * rng.normal());
    r.ok.assign(r.rows(), 1);
    r.decay.assign(r.rows(), 1.0);
    c.records.push_back(std::move(r));
  }
  return c;
}

std::vector<double> grown(const std::vector<double>& F, double share) {
  std::vector<double> out = F;
  for (const double tau_s : {2.0, 8.0, 30.0, 120.0}) {
    double state = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) out[i] += share / 4.0 * (state += (F[i] - state) * 0.02 / tau_s);
  }
  return out;
}

// A play of 0.3 N.
std::vector<double> looped(const std::vector<double>& F) {
  std::vector<double> out;
  double play = 0.0;
  for (const double f : F) {
    play = std::clamp(play, f - 0.3, f + 0.3);
    out.push_back(f + 0.2 * play);
  }
  return out;
}

TEST(HoldGrowth, CreepGrowsUnderLoadAndSinksBackAfterIt) {
  EXPECT_TRUE(grows_in_holds(stairs([](const std::vector<double>& F) { return grown(F, 0.05); })));
  EXPECT_TRUE(grows_in_holds(stairs([](const std::vector<double>& F) { return grown(looped(F), 0.05); }))) << "beside a loop too";
}

TEST(HoldGrowth, ALoopOrACurveStandsStillWhereTheForceDoes) {
  EXPECT_FALSE(grows_in_holds(stairs(looped)));
  EXPECT_FALSE(grows_in_holds(stairs([](std::vector<double> F) {
    for (double& f : F) f = std::pow(f, 1.2);
    return F;
  })));
}

TEST(HoldGrowth, AZeroThatDriftsDoesNotTurnBackWithTheLoad) {
  EXPECT_FALSE(grows_in_holds(stairs([](std::vector<double> F) {
    for (std::size_t i = 0; i < F.size(); ++i) F[i] += 0.2 * (1.0 - std::exp(-0.02 * static_cast<double>(i) / 60.0));
    return F;
  })));
}

TEST(HoldGrowth, NothingIsSaidOfCyclicRecordsOrWithoutHolds) {
  CampaignInput c = stairs([](const std::vector<double>& F) { return grown(F, 0.05); });
  for (RecordInput& r : c.records) r.dynamic = true;
  EXPECT_FALSE(grows_in_holds(c));
  EXPECT_FALSE(grows_in_holds(CampaignInput{}));
}

}  // namespace
}  // namespace forcegate::diagnose
