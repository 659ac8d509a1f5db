#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/base/rng.h"
#include "hil/gate/sinks.h"

namespace forcegate {
namespace {

constexpr double kRate_Hz = 1000.0, kLag_s = 0.003;

// Ten minutes of 0.5 Hz whose sensor is kLag_s late at the start and falls behind by `skew_ppm`; noise of 0.01 N on both.
LagDrift drift_of(double skew_ppm, double amplitude_N, std::size_t block_rows = 1000,
                  double duration_s = 600.0) {
  LagEstimator lag;
  lag.begin(kRate_Hz, 0.0, duration_s);
  Rng rng(11, "lag_drift");
  RigBlock rig;
  rig.resize(block_rows);
  std::vector<float> raw(block_rows);
  const auto total = static_cast<std::size_t>(duration_s * kRate_Hz);
  const auto force_N = [&](double t_s) { return 2.0 + amplitude_N * std::sin(3.14159265358979 * t_s); };
  for (std::size_t first = 0; first < total; first += block_rows) {
    for (std::size_t i = 0; i < block_rows; ++i) {
      const double t_s = static_cast<double>(first + i) / kRate_Hz;
      rig.t_s[i] = t_s;
      rig.force_ref_N[i] = static_cast<float>(force_N(t_s) + 0.01 * rng.normal());
      raw[i] = static_cast<float>(0.8 * force_N(t_s - kLag_s - 1e-6 * skew_ppm * t_s) + 0.01 * rng.normal());
    }
    RecordBlock b;
    b.rig = &rig;
    b.dut_N = b.raw_N = raw;
    b.n = block_rows;
    lag.push(b);
  }
  return lag.drift();
}

TEST(LagDrift, SeesAClockThatRunsSlowInTheSignalsThemselves) {
  for (const double skew_ppm : {-20.0, 5.0, 40.0}) {
    const LagDrift d = drift_of(skew_ppm, 1.0);
    EXPECT_NEAR(d.drift_ppm, skew_ppm, 3.0 * d.u_drift_ppm + 0.02 * std::fabs(skew_ppm)) << skew_ppm;
    EXPECT_LT(d.u_drift_ppm, 3.0);
    EXPECT_NEAR(d.first_lag_s, kLag_s + 150e-6 * skew_ppm, 2e-4);
    EXPECT_NEAR(d.second_lag_s, kLag_s + 450e-6 * skew_ppm, 2e-4);
  }
}

TEST(LagDrift, OfOneClockIsWithinItsUncertaintyWhateverTheBlocks) {
  const LagDrift large = drift_of(0.0, 1.0), small = drift_of(0.0, 1.0, 25);
  EXPECT_LT(std::fabs(large.drift_ppm), 3.0 * large.u_drift_ppm);
  EXPECT_EQ(large.drift_ppm, small.drift_ppm);
}

// 0.5 Hz whose codes are `late_s` behind, with a gain that falls tenfold in the record as that of a film under overload.
double raw_lag_of(double late_s, double follows = 1.0) {
  LagEstimator lag;
  lag.begin(kRate_Hz, 0.0, 600.0);
  Rng rng(12, "raw_lag");
  RigBlock rig;
  rig.resize(1000);
  std::vector<float> raw(1000);
  const auto force_N = [](double t_s) { return 2.0 + std::sin(3.14159265358979 * t_s); };
  for (std::size_t first = 0; first < 600000; first += 1000) {
    for (std::size_t i = 0; i < 1000; ++i) {
      const double t_s = static_cast<double>(first + i) / kRate_Hz;
      rig.t_s[i] = t_s;
      rig.force_ref_N[i] = static_cast<float>(force_N(t_s));
      raw[i] = static_cast<float>((1.0 - 0.9 * t_s / 600.0) * (follows * force_N(t_s - late_s) + (1.0 - follows) * 2.0) + 0.3 * rng.normal());
    }
    RecordBlock b;
    b.rig = &rig;
    b.dut_N = b.raw_N = raw;
    b.n = 1000;
    lag.push(b);
  }
  return lag.raw_lag_s();
}

TEST(RawLag, CodesThatAreAQuarterOfAPeriodAndMoreBehindAreFound) {
  for (const double late_s : {0.5, 0.7, 0.9}) EXPECT_NEAR(raw_lag_of(late_s), late_s, 0.041) << late_s;
  EXPECT_NEAR(raw_lag_of(-0.6), -0.6, 0.041) << "the ATI is the late one";
}

TEST(RawLag, OfCodesThatAreInTimeNothingIsSearchedFor) { EXPECT_NEAR(raw_lag_of(0.003), 0.003, 1e-3); }

TEST(RawLag, OfCodesThatDoNotFollowIsUnknown) { EXPECT_TRUE(std::isnan(raw_lag_of(0.0, 0.0))); }

TEST(LagDrift, OfARestIsUnknown) { EXPECT_TRUE(std::isnan(drift_of(0.0, 0.0).drift_ppm)); }

}  // namespace
}  // namespace forcegate
