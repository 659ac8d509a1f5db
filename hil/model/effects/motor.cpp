// Motor: a slow drive, and a wheel that does not turn evenly (cogging, an eccentric rotor) between command and force.
//   dF = c (L_tau[C] - C), C the commanded force;   dF = A sin th (a sin n th + b cos n th), n times a turn, A half the record's span.
// Never seen in U against F_ref.

#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

EffectForm one_pole() {
  return {.name = "one_pole",
          .shape = {{"tau_s", "s", 1e-3, 10.0, 0.3, "time constant; the ordinary lag of a drive is shorter"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the command behind the pole"}},
          .sign = StrengthSign::positive,
          .grid =
              [](const CampaignInput&) {
                return std::vector<std::vector<double>>{{0.3}, {0.8}};
              },
          .columns =
              [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                out.setZero();
                if (r.F_cmd_N.empty()) return;
                const auto y = low_pass_channel(r, r.F_cmd_N, shape[0], r.F_cmd_N[0]);
                for (std::size_t i = 0; i < r.rows(); ++i)
                  out(static_cast<Eigen::Index>(i), 0) = y[i] - r.F_cmd_N[i];
              }};
}

EffectForm ripple() {
  return {.name = "ripple",
          .shape = {{"per_turn", "1", 1.0, 50.0, 1.0, "times a turn of the wheel"}},
          .strength = {{"sine_rad", "rad", -1.0, 1.0, 0.0, "error of the angle in phase"},
                       {"cosine_rad", "rad", -1.0, 1.0, 0.0, "error of the angle in quadrature"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                if (c.has_theta)
                  for (int n = 1; n <= 16; ++n) out.push_back({static_cast<double>(n)});
                return out;
              },
          .columns =
              [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                out.setZero();
                for (std::size_t i = 0; i < r.sin_theta.size(); ++i) {
                  const double th = std::atan2(r.sin_theta[i], r.cos_theta[i]), arm = r.A_N * std::sin(th);
                  out(static_cast<Eigen::Index>(i), 0) = arm * std::sin(shape[0] * th);
                  out(static_cast<Eigen::Index>(i), 1) = arm * std::cos(shape[0] * th);
                }
              },
          .refine = false};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "motor",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary =
        "the wheel does not follow its command: the drive is slow or turns unevenly; the sensor is innocent",
    .equation = "F = C + c (L_tau[C] - C) + A sin th (a sin n th + b cos n th)",
    .source = "Lebosse et al. 2011, fig. 5: final force reached in 70 ms",
    .look_alikes = {"backlash", "lag"},
    .separates = "a step command: F_ref against the wheel angle stays a single curve",
    .needs = {"command"},
    .forms = {one_pole(), ripple()}}};

}  // namespace
}  // namespace forcegate
