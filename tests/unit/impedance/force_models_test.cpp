#include "hil/model/impedance/force_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "hil/base/rng.h"
#include "hil/model/impedance/two_variable.h"

namespace forcegate::test {
namespace {

using namespace impedance;

// A sensor whose conductance errs by `g_N` and whose capacitance by `c_N`, anew in each loading.
std::vector<ForceReading> loading(Rng& rng, double g_N, double c_N, double bend_N = 0.0) {
  const double g = g_N * rng.normal(), c = c_N * rng.normal();
  std::vector<ForceReading> out;
  for (double force = 5.0; force <= 250.0; force += 5.0) {
    const double share = force / 250.0, bent = force + 4.0 * bend_N * share * (1.0 - share);
    out.push_back({force, 0.016 * (bent + std::sqrt(3.0) * share * g + 0.05 * rng.normal()),
                   200e-12 + 1.8e-12 * (force + std::sqrt(3.0) * share * c + 0.05 * rng.normal())});
  }
  return out;
}

std::vector<ForceReading> join(const std::vector<std::vector<ForceReading>>& loadings) {
  std::vector<ForceReading> out;
  for (const auto& l : loadings) out.insert(out.end(), l.begin(), l.end());
  return out;
}

TEST(ForceModels, lines_recover_a_linear_sensor) {
  Rng rng(1);
  const auto readings = loading(rng, 0.0, 0.0);
  EXPECT_NEAR(fit_conductance(readings).force_N(0.016 * 100.0), 100.0, 0.05);
  EXPECT_NEAR(fit_capacitance(readings).force_N(200e-12 + 1.8e-12 * 100.0), 100.0, 0.05);
}

TEST(ForceModels, error_reduction_is_equation_11) {
  EXPECT_NEAR(error_reduction_pct(0.330, 0.547), 39.7, 0.05);
}

TEST(Network, learns_a_bent_sensor_better_than_a_line_and_the_same_seed_gives_the_same_bits) {
  Rng rng(2);
  const auto training = join(
                 {loading(rng, 0.3, 0.2, 3.0), loading(rng, 0.3, 0.2, 3.0), loading(rng, 0.3, 0.2, 3.0)}),
             test = loading(rng, 0.1, 0.1, 3.0);
  const auto network = train_network(training, 7), again = train_network(training, 7);
  ASSERT_TRUE(network.has_value()) << network.error().to_text();
  const auto line = fit_conductance(training);
  const double by_network = mean_squared_error_N2(
      test, [&](const ForceReading& r) { return network->force_N(r.output_V, r.capacitance_F); });
  const double by_line =
      mean_squared_error_N2(test, [&](const ForceReading& r) { return line.force_N(r.output_V); });
  EXPECT_LT(by_network, 0.3 * by_line);
  EXPECT_EQ(network->weights, again->weights);
  EXPECT_LT(network->training_rmse_N, 0.6);
}

TEST(Network, refuses_readings_that_carry_no_network) {
  EXPECT_FALSE(train_network(std::vector<ForceReading>(40, ForceReading{10.0, 1.0, 3e-10}), 1).has_value());
  Rng rng(3);
  const auto few = loading(rng, 0.1, 0.1);
  EXPECT_FALSE(train_network(std::span(few).first(10), 1).has_value());
}

TEST(TwoVariable, beats_both_variables_and_covers_new_loadings_as_it_states) {
  Rng rng(4);
  double by_g = 0, by_c = 0, by_both = 0;
  int covered = 0, n = 0;
  for (int pack = 0; pack < 40; ++pack) {
    std::vector<std::vector<std::vector<ForceReading>>> sensors(8);
    for (auto& s : sensors)
      for (int l = 0; l < 3; ++l) s.push_back(loading(rng, 1.0, 0.6));
    const auto models = fit_two_variable(sensors);
    ASSERT_TRUE(models.has_value()) << models.error().to_text();
    for (std::size_t s = 0; s < 8; ++s) {
      const auto test = loading(rng, 1.0, 0.6), training = join(sensors[s]);
      const auto g = fit_conductance(training), c = fit_capacitance(training);
      by_g += mean_squared_error_N2(test, [&](const ForceReading& r) { return g.force_N(r.output_V); });
      by_c += mean_squared_error_N2(test, [&](const ForceReading& r) { return c.force_N(r.capacitance_F); });
      by_both += mean_squared_error_N2(test, [&](const ForceReading& r) {
        return (*models)[s].estimate(r.output_V, r.capacitance_F).force_N;
      });
      for (const ForceReading& r : test) {
        const auto e = (*models)[s].estimate(r.output_V, r.capacitance_F);
        covered += std::abs(e.force_N - r.force_N) <= 2.45 * e.u_N ? 1 : 0;  // Student, 6 degrees of freedom
        ++n;
      }
    }
  }
  EXPECT_LT(by_both, by_c);
  EXPECT_LT(by_c, by_g);
  EXPECT_GT(covered / static_cast<double>(n), 0.93);
}

TEST(TwoVariable, needs_two_loadings) {
  Rng rng(5);
  EXPECT_FALSE(fit_two_variable({{loading(rng, 1.0, 0.5)}}).has_value());
}

}  // namespace
}  // namespace forcegate::test
