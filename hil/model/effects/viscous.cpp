// A share of the output that goes with the rate of the input: viscous friction, a damper beside a spring. Recordings of
// other machines only; in a force sensor the same signature is a lead (piezocapacitance, a late reference).
//   dU = g c R |v/v0|^n sgn v, R the force range, v = dF/dt behind a short mean, v0 its RMS.    n = 1 viscous, n = 1/2 thinning

#include <algorithm>
#include <cmath>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

constexpr std::size_t kHalf = 6;  // rows on either side of the difference: positions are noisy

std::vector<double> smooth_rate(const RecordInput& r) {
  const std::size_t n = r.rows();
  std::vector<double> out(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i > kHalf ? i - kHalf : 0, b = std::min(i + kHalf, n - 1);
    if (b > a && r.t_s[b] > r.t_s[a]) out[i] = (r.F_N[b] - r.F_N[a]) / (r.t_s[b] - r.t_s[a]);
  }
  return out;
}

EffectForm form(const char* name, double exponent) {
  return {
      .name = name,
      .shape = {},
      .strength = {{"c", "1", -100.0, 100.0, 0.0, "output at the RMS rate, shares of the input's span"}},
      .sign = StrengthSign::either,
      .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
      .columns =
          [exponent](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            const std::vector<double> v = smooth_rate(r);
            double square = 0.0;
            for (double x : v) square += x * x;
            const double v0 = std::sqrt(square / std::max<double>(1.0, static_cast<double>(v.size())));
            for (std::size_t i = 0; i < v.size(); ++i)
              out(static_cast<Eigen::Index>(i), 0) =
                  v0 > 0.0 ? c.range_N * std::copysign(std::pow(std::abs(v[i]) / v0, exponent), v[i]) : 0.0;
          }};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "viscous",
    .side = "rig",
    .summary = "a share of the output goes with the rate of the input and changes its sign with it",
    .equation = "dU = g c |dF/dt|^n sgn(dF/dt)",
    .source = "viscous friction; shear-thinning grease",
    .look_alikes = {"hysteresis", "lag", "piezocapacitance"},
    .separates =
        "the same stroke at speeds a decade apart: a viscous loop grows with the speed, hysteresis keeps its width",
    .needs = {Need::generic},
    .forms = {form("linear", 1.0), form("thinning", 0.5)}}};

}  // namespace
}  // namespace forcegate
