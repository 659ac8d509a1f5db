// Off-axis push: the eccentric wheel also pushes sideways.  dU = g D (c1 sin th + c2 F sin th / R).
// Form cam: the pressure angle of an eccentric grows with its eccentricity, so that a record of half the stroke has half the push.
// Form odd: sin 2 th and sin 3 th beside sin th.
// With a turning wheel a loop that keeps its width at any speed; in servo mode a single curve: the clash is the signature.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

// Half the stroke of the record's force, from its line over cos th: an eccentric pushes sideways in proportion to its eccentricity.
double arm_N(const RecordInput& r) {
  if (r.cos_theta.size() != r.rows()) return 0.0;
  double n = 0.0, x1 = 0.0, y1 = 0.0, xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0) continue;
    const double x = 1.0 - r.cos_theta[i], y = r.F_N[i];
    n += 1.0;
    x1 += x;
    y1 += y;
    xx += x * x;
    xy += x * y;
  }
  const double spread = n * xx - x1 * x1;
  return spread > 1e-9 * n * n ? std::max(0.0, (n * xy - x1 * y1) / spread) : 0.0;
}

// A wheel that stays on one side, over one geometry, pushes sideways by a function of the force: no bent curve could be told from it. Variance of
// sin th at one force, of all of it.
std::vector<std::vector<double>> where_sides_differ(const CampaignInput& c) {
  constexpr std::size_t kBins = 200;  // near a dead point the force hardly changes with the angle
  constexpr double kDiffer = 0.05;
  struct Moments {
    double n = 0.0, sum = 0.0, square = 0.0;
    void add(double x) { n += 1.0, sum += x, square += x * x; }
    double scatter() const { return n > 0.0 ? square - sum * sum / n : 0.0; }
  };
  std::array<Moments, kBins> at_force;
  Moments all;
  double low = 1e300, high = -1e300;
  for (const RecordInput& r : c.records)
    if (!r.sin_theta.empty())
      for (const double F : r.F_N) low = std::min(low, F), high = std::max(high, F);
  for (const RecordInput& r : c.records)
    for (std::size_t i = 0; i < r.sin_theta.size(); ++i) {
      if (r.ok[i] == 0) continue;
      const double share = high > low ? (r.F_N[i] - low) / (high - low) : 0.0;
      at_force[std::min(kBins - 1, static_cast<std::size_t>(share * kBins))].add(r.sin_theta[i]);
      all.add(r.sin_theta[i]);
    }
  double within = 0.0;
  for (const Moments& bin : at_force) within += bin.scatter();
  return within > kDiffer * all.scatter() ? std::vector<std::vector<double>>{{}} : std::vector<std::vector<double>>{};
}

EffectForm cam() {
  return {.name = "cam",
          .shape = {},
          .strength = {{"c1", "1", -10.0, 10.0, 0.0, "sideways push over half the stroke, constant part"},
                       {"c2", "1", -10.0, 10.0, 0.0, "the same, part that grows with the force"}},
          .sign = StrengthSign::either,
          .grid = where_sides_differ,
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                out.setZero();
                if (r.sin_theta.empty()) return;
                const double arm = arm_N(r);
                r.for_each_wanted([&](std::size_t i) {
                  const double s = r.decay[i] * arm * r.sin_theta[i];
                  out(static_cast<Eigen::Index>(i), 0) = s;
                  out(static_cast<Eigen::Index>(i), 1) = s * r.F_N[i] / c.range_N;
                });
              },
          .singles = true};
}

EffectForm form(const char* name, bool decayed) {
  return {
      .name = name,
      .shape = {},
      .strength = {{"c1_N", "N", -10.0, 10.0, 0.0, "sideways push, constant part"},
                   {"c2", "1", -2.0, 2.0, 0.0, "sideways push, part that grows with the force"}},
      .sign = StrengthSign::either,
      .grid = where_sides_differ,
      .columns =
          [decayed](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            out.setZero();
            if (r.sin_theta.empty()) return;
            r.for_each_wanted([&](std::size_t i) {
              const double s = (decayed ? r.decay[i] : 1.0) * r.sin_theta[i];
              out(static_cast<Eigen::Index>(i), 0) = s;
              out(static_cast<Eigen::Index>(i), 1) = s * r.F_N[i] / c.range_N;
            });
          },
      .singles = true};
}

// What else turns over with the sense of rotation: a tilt that saturates, an angle of pressure that grows with the arm. What does not turn over
// is a function of the force; what goes round twice or thrice a turn and not once is another fault of the wheel.
EffectForm odd() {
  constexpr int kFirst = 2, kLast = 3;
  EffectForm out = form("odd", true);
  out.strength.clear();
  for (int k = kFirst; k <= kLast; ++k) {
    const std::string n = std::to_string(k);
    out.strength.push_back({"c" + n + "_N", "N", -10.0, 10.0, 0.0, "of sin " + n + " th, constant part"});
    out.strength.push_back({"d" + n, "1", -2.0, 2.0, 0.0, "the same, part that grows with the force"});
  }
  out.columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef columns) {
    columns.setZero();
    if (r.sin_theta.empty()) return;
    r.for_each_wanted([&](std::size_t i) {
      // sin k th by Chebyshev's recurrence
      double before = 0.0, now = r.decay[i] * r.sin_theta[i];
      for (int k = kFirst; k <= kLast; ++k) {
        const double next = 2.0 * r.cos_theta[i] * now - before;
        before = now;
        now = next;
        columns(static_cast<Eigen::Index>(i), 2 * (k - kFirst)) = now;
        columns(static_cast<Eigen::Index>(i), 2 * (k - kFirst) + 1) = now * r.F_N[i] / c.range_N;
      }
    });
  };
  out.singles = false;
  out.bank = true;
  out.only_further = true;
  return out;
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "off_axis",
               .side = "rig",
               .summary = "the output depends on the side from which the wheel pushes",
               .equation = "dU = g D (c1 sin th + c2 F sin th / R)",
               .source = "geometry of an eccentric wheel; Lebosse et al. 2011, fig. 3",
               .look_alikes = {"hysteresis", "static_nonlinearity"},
               .separates = "the same cycle with the wheel turning the other way: the loop flips",
               .needs = {Need::theta},
               .traits = {.known_form = true},
               .forms = {form("sine", true), form("sine_undecayed", false), cam(), odd()}}};

}  // namespace
}  // namespace forcegate
