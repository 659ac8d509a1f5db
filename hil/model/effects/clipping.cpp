// Amplifier rail: U stops at a voltage, whatever the force.  dU = -g c softplus(W - Wr); follows U, so it vanishes once
// the decay has lowered U (a static nonlinearity stays).  The samples at the rail themselves are seen by the raw checks.

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

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
         .shape = {{"Wr_N", "N", 0.0, 1000.0, 4.0, "decayed force at which the rail is met"}},
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
               const double rail = shape[0], width = 0.01 * c.range_N;
               add_curve(
                   r, CurveAt::decayed, [=](double W) { return -soft_hinge(W - rail, width); }, out.col(0));
             },
         .least = 0.0,
         .most = 1.15}}}};

}  // namespace
}  // namespace forcegate
