#include <algorithm>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

bool claims(const Diagnosis& d, const std::string& effect) {
  return std::any_of(d.findings.begin(), d.findings.end(),
                     [&](const Finding& f) { return f.effect == effect && f.probability >= 0.5; });
}

std::string told(const Diagnosis& d) {
  std::string out;
  for (const Finding& f : d.findings) out += f.effect + " " + std::to_string(f.probability) + "; ";
  for (const std::string& note : d.notes) out += "\n" + note;
  return out;
}

// A curve that saturates, and a slow growth of two time constants: neither is an error of the other's form.
TEST(TwoEffects, ACurveAndAGrowthOfTheSameSizeAreBothNamed) {
  const Diagnosis d =
      answer(make_campaign(41, [](const std::vector<double>& t, const std::vector<double>& F, int) {
        std::vector<double> U;
        double fast = 0.0, slow = 0.0;
        for (std::size_t i = 0; i < F.size(); ++i) {
          const double dt = i == 0 ? 0.0 : t[i] - t[i - 1];
          fast += (F[i] - fast) * -std::expm1(-dt / 5.0);
          slow += (F[i] - slow) * -std::expm1(-dt / 50.0);
          U.push_back(8.0 * std::tanh((F[i] + 0.015 * fast + 0.03 * slow) / 6.0) + 0.2);
        }
        return U;
      }));
  EXPECT_TRUE(claims(d, "static_nonlinearity")) << told(d);
  EXPECT_TRUE(claims(d, "creep")) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
