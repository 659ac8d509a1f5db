// Clocks that run apart, in a sweep and where the same frequency comes again.

#include "hil/diagnose/answer/swept_force.h"

#include "tests/unit/diagnose/made_recording.h"

namespace forcegate::diagnose {
namespace {

constexpr double kRate_Hz = 200.0, kDuration_s = 80.0;

double swept(double t) { return 2.0 + std::sin(2.0 * std::numbers::pi * (0.5 + 0.5 * 3.0 / kDuration_s * t) * t); }
double back(double t) { return t < 0.5 * kDuration_s ? swept(2.0 * t) : swept(2.0 * (kDuration_s - t)); }

// U = 0.3 + 2 F(t - skew t)
Diagnosis on_two_clocks(double (*force)(double), double skew) {
  Campaign c = recording(kRate_Hz, static_cast<std::size_t>(kRate_Hz * kDuration_s), force,
                         [&](const std::vector<double>& t, const std::vector<double>&) {
                           std::vector<double> out;
                           for (const double s : t) out.push_back(0.3 + 2.0 * force(s * (1.0 - skew)));
                           return out;
                         },
                         0.003);
  return answer(c);
}

TEST(SweptForce, TwoClocksAreNoClaimInASweepAlone) {
  const Diagnosis sweep = on_two_clocks(swept, 2e-4);
  EXPECT_LT(probability(sweep, "clock_skew"), 0.5) << told(sweep);
  EXPECT_GT(probability(sweep, "clock_skew"), 0.2) << told(sweep);
  EXPECT_EQ(sweep.verdict, DiagnosisVerdict::unknown) << told(sweep);
  const Diagnosis there_and_back = on_two_clocks(back, 2e-4);
  EXPECT_GT(probability(there_and_back, "clock_skew"), 0.8) << told(there_and_back);
}

TEST(SweptForce, TimeIsFrequencyWhereTheForceGoesFasterAndFaster) {
  const auto of = [](double (*force)(double)) {
    CampaignInput c;
    RecordInput& r = c.records.emplace_back();
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.02 * i, step = 1e-4;
      r.t_s.push_back(t);
      r.F_N.push_back(force(t));
      r.rate_N_per_s.push_back((force(t + step) - force(t - step)) / (2.0 * step));
      r.ok.push_back(1);
    }
    return time_as_frequency(c);
  };
  EXPECT_GT(of(swept), 0.98);
  EXPECT_LT(of(back), 0.3);
  EXPECT_LT(of([](double t) { return std::sin(3.0 * t); }), 0.3);
  EXPECT_EQ(of([](double) { return 1.0; }), 0.0);
  EXPECT_EQ(time_as_frequency({}), 0.0);
}

}  // namespace
}  // namespace forcegate::diagnose
