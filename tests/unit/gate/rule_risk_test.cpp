// The zones of the rule against JCGM 106:2012, guarded acceptance with w = U = 2 u (8.3.2): the probability that the measurand
// conforms is the normal distribution over the tolerance (7.2), made here from erfc alone.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "hil/base/rng.h"
#include "hil/gate/rule.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

/// Of a value y with standard uncertainty u below an upper limit.
double conformance_probability(double y, double u, double limit) { return 0.5 * std::erfc((y - limit) / (u * std::sqrt(2.0))); }

// Example in the manner of clause 7.4: -5.47 V +- 0.05 V under a limit of -5.40 V; Phi(1.4) from any table.
TEST(RuleRisk, the_probability_of_conformance_is_that_of_tables) {
  EXPECT_NEAR(conformance_probability(-5.47, 0.05, -5.40), 0.9192, 5e-5);
}

TEST(RuleRisk, the_zones_of_the_rule_are_guard_bands_of_two_standard_uncertainties) {
  Rng rng(7, "zones");
  std::map<Verdict, int> seen;
  for (int i = 0; i < 2000; ++i) {
    Check c;
    c.limit = {Limit::Kind::upper, 4.5, "test"};
    c.u = 0.05 + rng.uniform();
    c.value = 4.5 + 3.0 * c.u * (2.0 * rng.uniform() - 1.0);
    const double conforms = conformance_probability(c.value, c.u, 4.5);
    const Verdict verdict = zone(c, coverage_factor(0.9545, 0.0) * c.u);
    ++seen[verdict];
    if (verdict == Verdict::pass) {
      EXPECT_GE(conforms, 0.9772);
    }
    if (verdict == Verdict::marginal) {
      EXPECT_TRUE(conforms >= 0.5 && conforms < 0.9773);
    }
    if (verdict == Verdict::inconclusive) {
      EXPECT_TRUE(conforms < 0.5 && conforms > 0.0227);
    }
    if (verdict == Verdict::fail) {
      EXPECT_LE(conforms, 0.0228);
    }
  }
  EXPECT_EQ(seen.size(), 4U);
  for (const Verdict v : {Verdict::pass, Verdict::marginal, Verdict::inconclusive, Verdict::fail}) EXPECT_GT(seen[v], 200) << to_string(v);
}

}  // namespace
}  // namespace forcegate
