#include <cmath>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Two stores fill while the load is cycled (every fourth record) and empty at their own rates, whatever moves meanwhile. Nobody says which
// records are cyclic, and the maxima do not decay by any law of the model.
Campaign that_recovers(std::uint64_t seed, double share) {
  constexpr double kFull_s = 90.0, kEmpty_s[2] = {300.0, 2500.0};
  double store[2] = {0.0, 0.0}, clock_s = 0.0;
  return make_campaign(seed, [=](const std::vector<double>& t, const std::vector<double>& F, int record) mutable {
    const double start_s = 900.0 * record;
    std::vector<double> U;
    for (std::size_t j = 0; j < 2; ++j) store[j] *= std::exp(-(start_s - clock_s) / kEmpty_s[j]);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double step_s = i == 0 ? 0.0 : t[i] - t[i - 1];
      for (std::size_t j = 0; j < 2; ++j) store[j] = record % 4 == 3 ? 1.0 - (1.0 - store[j]) * std::exp(-step_s / kFull_s) : store[j] * std::exp(-step_s / kEmpty_s[j]);
      U.push_back(2.0 * F[i] * (1.0 + share * (0.5 * store[0] + 0.5 * store[1])) + 0.2);
    }
    clock_s = start_s + t.back();
    return U;
  });
}

TEST(SlowRecovery, IsFoundWhereNoRecordIsCalledCyclic) {
  for (const double share : {0.1, -0.1}) {
    const Diagnosis d = answer(that_recovers(7, share));
    ASSERT_FALSE(d.findings.empty()) << share;
    EXPECT_EQ(d.findings.front().effect, "slow_recovery") << share << '\n' << told(d);
    EXPECT_GE(d.findings.front().probability, 0.8) << share << '\n' << told(d);
  }
}

TEST(SlowRecovery, IsNotFoundWhereNothingRecovers) { EXPECT_EQ(answer(that_recovers(7, 0.0)).verdict, DiagnosisVerdict::none); }

}  // namespace
}  // namespace forcegate::diagnose
