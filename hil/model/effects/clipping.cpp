// Amplifier rail: U stops at a voltage, whatever the force.  dU = -g c softplus(W - Wr); follows U, so it vanishes once
// the decay has lowered U (a static nonlinearity stays). Wr is where the mean sensor meets the voltage; a record whose zero
// and gain differ meets it at its own force, (V(Wr) - zero_k) / gain_k. Runs of one value at the rail are seen by the raw
// checks; with a converter's noise on them no two samples are alike.

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

struct Line {
  double zero_V, gain_V_per_N;
};

// U against the decayed force below `rail_N`. Nothing where the output is not known or the force hardly moves there.
std::optional<Line> line_below(std::span<const RecordInput> records, double rail_N, double range_N) {
  constexpr double kBelow = 0.06, kMoves = 0.15;  // shares of the span
  constexpr std::size_t kRows = 1000, kFewest = 30;
  double n = 0.0, W = 0.0, U = 0.0, WW = 0.0, WU = 0.0, least_N = rail_N, most_N = -rail_N;
  for (const RecordInput& r : records) {
    if (r.U_V.size() != r.rows()) continue;
    const std::size_t stride = std::max<std::size_t>(1, r.rows() / kRows);
    for (std::size_t i = 0; i < r.rows(); i += stride) {
      const double w = r.base_force_N(i);
      if (r.ok[i] == 0 || !(w < rail_N - kBelow * range_N) || !std::isfinite(r.U_V[i])) continue;
      n += 1.0;
      W += w;
      U += r.U_V[i];
      WW += w * w;
      WU += w * r.U_V[i];
      least_N = std::min(least_N, w);
      most_N = std::max(most_N, w);
    }
  }
  if (n < kFewest || most_N - least_N < kMoves * range_N) return std::nullopt;
  const double gain = (n * WU - W * U) / (n * WW - W * W);
  return Line{(U - gain * W) / n, gain};
}

double own_rail(const CampaignInput& c, const RecordInput& r, double rail_N) {
  constexpr double kFurthest = 0.15, kLeastGain = 0.5;
  const auto mean = line_below(c.records, rail_N, c.range_N), own = line_below({&r, 1}, rail_N, c.range_N);
  if (!mean || !own || !(own->gain_V_per_N / mean->gain_V_per_N > kLeastGain)) return rail_N;
  const double own_N = (mean->zero_V + mean->gain_V_per_N * rail_N - own->zero_V) / own->gain_V_per_N;
  return std::clamp(own_N, rail_N - kFurthest * c.range_N, rail_N + kFurthest * c.range_N);
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "clipping",
    .side = "instrument",
    .summary = "the output stops at a fixed voltage while the force goes on",
    .equation = "dU = -g c max(0, W - Wr)",
    .source = "operational amplifier at its rail",
    .look_alikes = {"static_nonlinearity"},
    .separates = "the same load with the gain halved: a corner fixed in volts moves in newtons",
    .needs = {},
    .forms = {
        {.name = "rail",
         .shape = {{"Wr_N", "N", 0.0, 1000.0, 4.0, "decayed force at which the mean sensor meets the rail"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "1: the output stops"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput& c) {
               std::vector<std::vector<double>> out;
               for (double at : {0.6, 0.7, 0.78, 0.85, 0.91, 0.96})
                 out.push_back({c.lowest_N + at * c.range_N});
               return out;
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const double rail = own_rail(c, r, shape[0]), width = 0.01 * c.range_N;
               add_curve(
                   r, CurveAt::decayed, [=](double W) { return -soft_hinge(W - rail, width); }, out.col(0));
             },
         .least = 0.0,
         .most = 1.15}}}};

}  // namespace
}  // namespace forcegate
