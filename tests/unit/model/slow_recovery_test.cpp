#include <gtest/gtest.h>

#include <cmath>

#include "hil/model/effect.h"
#include "synthetic.h"

namespace forcegate {
namespace {

// x' = (1 - x) |F'| / (L R) - x / tau_rest in small steps over all records and the rests between them.
std::vector<double> states(const CampaignInput& c, double spans_up, double rest_s, std::size_t record) {
  constexpr double kStep_s = 0.01;
  std::vector<double> out;
  double x = 0.0, clock_s = c.records.front().start_s;
  for (std::size_t k = 0; k <= record; ++k) {
    const RecordInput& r = c.records[k];
    x *= std::exp(-std::max(0.0, r.start_s - clock_s) / rest_s);
    double t_s = 0.0, travel_N = 0.0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double seconds = std::max(0.0, r.t_s[i] - t_s), rate = seconds > 0.0 ? (r.travel_N[i] - travel_N) / (c.range_N * seconds) : 0.0;
      const int steps = static_cast<int>(std::ceil(seconds / kStep_s));
      for (int s = 0; s < steps; ++s) x += seconds / steps * ((1.0 - x) * rate / spans_up - x / rest_s);
      t_s = r.t_s[i];
      travel_N = r.travel_N[i];
      if (k == record) out.push_back(x);
    }
    clock_s = r.start_s + r.duration_s;
  }
  return out;
}

TEST(SlowRecovery, IsChargedByTheLoadThatComesAndGoesAndFadesInTheRests) {
  auto made = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F - 0.2; }));
  ASSERT_TRUE(made.has_value());
  CampaignInput& c = *made;
  ASSERT_GE(c.records.size(), 3U);
  for (RecordInput& r : c.records) r.dynamic = false;
  const EffectKind* kind = EffectRegistry::instance().find("slow_recovery");
  ASSERT_NE(kind, nullptr);
  const EffectForm* form = find_form(*kind, "by_travel");
  ASSERT_NE(form, nullptr);
  const double shape[] = {20.0, 400.0};
  for (const std::size_t k : {std::size_t{0}, std::size_t{2}}) {
    const RecordInput& r = c.records[k];
    Eigen::MatrixXd column = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()), 1);
    form->columns(c, r, shape, column);
    const std::vector<double> x = states(c, shape[0], shape[1], k);
    EXPECT_GT(x.back(), 0.02) << k;
    for (std::size_t i = 0; i < r.rows(); i += 97)
      EXPECT_NEAR(column(static_cast<Eigen::Index>(i), 0), x[i] * r.base_force_N(i), 0.01 * x.back() * c.range_N) << k << ' ' << i;
  }
}

}  // namespace
}  // namespace forcegate
