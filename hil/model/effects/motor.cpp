// Motor: a slow drive, and a wheel that does not turn evenly (cogging, an eccentric rotor) between command and force.
//   dF = c (L_tau[C] - C), C the commanded force;   dF = A sin th (a sin n th + b cos n th), n times a turn, A half the record's span;
//   dF = a sin (2 pi n C / span) + b cos (2 pi n C / span) of a machine whose angle nobody reads.
// Never seen in U against F_ref.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

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
                r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = y[i] - r.F_cmd_N[i]; });
              },
          .least = 0.2};  // a servo loop leaves a slow tail of some per cent
}

// Where the wheel goes to and fro, at another speed, the servo's own unevenness hides the drive's.
bool goes_round(const RecordInput& r) {
  double low = 0.0, high = 0.0, turned = 0.0;
  for (std::size_t i = 1; i < r.sin_theta.size(); ++i) {
    turned += std::atan2(r.sin_theta[i] * r.cos_theta[i - 1] - r.cos_theta[i] * r.sin_theta[i - 1],
                         r.cos_theta[i] * r.cos_theta[i - 1] + r.sin_theta[i] * r.sin_theta[i - 1]);
    low = std::min(low, turned);
    high = std::max(high, turned);
  }
  return high - low > 4.0 * std::numbers::pi;
}

// Columns a sin n th + b cos n th of an error of the angle, for each n in turn; nothing where the wheel does not go round.
template <class Multiples>
void fill_multiples(const RecordInput& r, const Multiples& multiples, ColumnsRef out) {
  out.setZero();
  if (!goes_round(r)) return;
  for (std::size_t i = 0; i < r.sin_theta.size(); ++i) {
    const double th = std::atan2(r.sin_theta[i], r.cos_theta[i]), arm = r.A_N * std::sin(th);
    Eigen::Index column = 0;
    for (const double n : multiples) {
      out(static_cast<Eigen::Index>(i), column++) = arm * std::sin(n * th);
      out(static_cast<Eigen::Index>(i), column++) = arm * std::cos(n * th);
    }
  }
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
          .columns = [](const CampaignInput&, const RecordInput& r, std::span<const double> shape,
                        ColumnsRef out) { fill_multiples(r, shape, out); },
          .refine = false};
}

// A drive that turns unevenly seldom does so at one multiple alone.
EffectForm ripples() {
  static constexpr std::array<double, 6> kMultiples = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  EffectForm form;
  form.name = "ripples";
  form.sign = StrengthSign::either;
  for (std::size_t n = 1; n <= kMultiples.size(); ++n)
    for (const char* part : {"sine_", "cosine_"})
      form.strength.push_back({part + std::to_string(n) + "_rad", "rad", -1.0, 1.0, 0.0,
                               "error of the angle, so many times a turn"});
  form.grid = [](const CampaignInput& c) {
    return c.has_theta ? std::vector<std::vector<double>>{{}} : std::vector<std::vector<double>>{};
  };
  form.columns = [](const CampaignInput&, const RecordInput& r, std::span<const double>, ColumnsRef out) {
    fill_multiples(r, kMultiples, out);
  };
  form.refine = false;
  return form;
}

// A machine without an angle: what its screw or rack does comes again every so many newtons of the command.
EffectForm pitch() {
  return {.name = "pitch",
          .shape = {{"per_range", "1", 3.0, 40.0, 6.0, "times over the range of the force"}},
          .strength = {{"sine_N", "N", -5.0, 5.0, 0.0, "error of the force in phase"},
                       {"cosine_N", "N", -5.0, 5.0, 0.0, "error of the force in quadrature"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput& c) {
                constexpr double kStep = 0.35;  // the phase at the ends is then known to a third of a right angle
                std::vector<std::vector<double>> out;
                if (!c.has_theta)
                  for (double n = 3.0; n <= 16.0; n += kStep) out.push_back({n});
                return out;
              },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                out.setZero();
                if (r.F_cmd_N.empty()) return;
                r.for_each_wanted([&](std::size_t i) {
                  const double phase = 2.0 * std::numbers::pi * shape[0] * (r.F_cmd_N[i] - c.lowest_N) / c.range_N;
                  out(static_cast<Eigen::Index>(i), 0) = std::sin(phase);
                  out(static_cast<Eigen::Index>(i), 1) = std::cos(phase);
                });
              }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "motor",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary =
        "the wheel does not follow its command: the drive is slow or turns unevenly; the sensor is innocent",
    .equation = "F = C + c (L_tau[C] - C) + A sin th (a sin n th + b cos n th), or + a sin k C + b cos k C",
    .source = "Lebosse et al. 2011, fig. 5: final force reached in 70 ms",
    .look_alikes = {"backlash", "lag"},
    .separates = "a step command: F_ref against the wheel angle stays a single curve",
    .needs = {Need::command},
    .forms = {one_pole(), ripple(), ripples(), pitch()}}};

}  // namespace
}  // namespace forcegate
