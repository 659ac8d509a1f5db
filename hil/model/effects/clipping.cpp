// Amplifier rail: U stops at a voltage, whatever the force.  dU = -g c softplus(W - Wr); follows U, so it vanishes once
// the decay has lowered U (a static nonlinearity stays). Wr is where the mean sensor meets the voltage; a record whose zero
// and gain differ meets it at its own force, (V(Wr) - zero_k) / gain_k, and falls off it with its own gain. Runs of one value at the rail are seen by the raw
// checks; with a converter's noise on them no two samples are alike.

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/base/evenly_chosen.h"
#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

struct Line {
  double zero_V = 0.0, gain_V_per_N = 0.0;
};

// The record's output against the decayed force below `rail_N`. Nothing where the output is not known or the force hardly moves there.
std::optional<Line> line_below(const RecordInput& r, double rail_N, double range_N) {
  constexpr double kBelow = 0.06, kMoves = 0.15;  // shares of the span
  constexpr std::size_t kRows = 1000, kFewest = 30;
  if (r.U_V.size() != r.rows()) return std::nullopt;
  double n = 0.0, W = 0.0, U = 0.0, WW = 0.0, WU = 0.0, least_N = rail_N, most_N = -rail_N;
  EvenlyChosen choice(r.rows(), kRows);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0 || !choice.next()) continue;
    const double w = r.base_force_N(i);
    if (!(w < rail_N - kBelow * range_N) || !std::isfinite(r.U_V[i])) continue;
    n += 1.0;
    W += w;
    U += r.U_V[i];
    WW += w * w;
    WU += w * r.U_V[i];
    least_N = std::min(least_N, w);
    most_N = std::max(most_N, w);
  }
  if (n < kFewest || most_N - least_N < kMoves * range_N) return std::nullopt;
  const double gain = (n * WU - W * U) / (n * WW - W * W);
  return Line{(U - gain * W) / n, gain};
}

struct Rail {
  double at_N;        // decayed force at which the record meets it
  double share = 1.0; // the record's gain, share of the mean sensor's
};

Rail own_rail(const CampaignInput& c, const RecordInput& r, double rail_N) {
  constexpr double kFurthest = 0.15, kLeastGain = 0.5;
  const auto own = line_below(r, rail_N, c.range_N);
  if (!own) return {rail_N};
  Line mean;
  double n = 0.0;
  for (const RecordInput& record : c.records)
    if (const auto line = line_below(record, rail_N, c.range_N)) {
      mean.zero_V += line->zero_V;
      mean.gain_V_per_N += line->gain_V_per_N;
      n += 1.0;
    }
  mean.zero_V /= n;
  mean.gain_V_per_N /= n;
  const double share = own->gain_V_per_N / mean.gain_V_per_N;
  if (!(share > kLeastGain && share < 1.0 / kLeastGain)) return {rail_N};
  const double own_N = (mean.zero_V + mean.gain_V_per_N * rail_N - own->zero_V) / own->gain_V_per_N;
  return {std::clamp(own_N, rail_N - kFurthest * c.range_N, rail_N + kFurthest * c.range_N), share};
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
    .traits = {.any_course = true, .at_voltages = true, .in_samples = true},
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
               const Rail rail = own_rail(c, r, shape[0]);
               const double width = 0.002 * c.range_N;
               add_curve(
                   r, CurveAt::decayed, [=](double W) { return -rail.share * soft_hinge(W - rail.at_N, width); }, out.col(0));
             },
         .least = 0.0,
         .most = 1.4}}}};  // on a grid: a hinge set too high falls off too steeply

}  // namespace
}  // namespace forcegate
