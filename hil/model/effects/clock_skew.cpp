// Two clocks that do not run at the same rate: the shift grows within a record, a fan-shaped residual.
//   dU = g D c (F(t - e t) - F(t)),  e the relative rate difference;
//   dU = g D c (F(t - T n(t)) - F(t)),  T a block of samples that a logger lost, n(t) how many it has lost by then: a shift that grows in steps.

#include "hil/model/effect.h"
#include "hil/model/states.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "clock_skew",
    .side = "instrument",
    .summary = "the sensor's clock and the reference's run apart: the shift grows within each record",
    .equation = "dU = g D c (F(t - e t) - F(t))",
    .source = "crystal tolerance of two free-running devices",
    .look_alikes = {"delay", "lag"},
    .separates = "the same fast edge at the start and at the end of a long record",
    .needs = {},
    .traits = {.timing = true},
    .forms = {
        {.name = "linear",
         .shape = {{"skew", "1", -0.05, 0.05, 1e-4, "relative rate difference"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the signal on the other clock"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput&) {
               std::vector<std::vector<double>> out;
               for (double e : {1e-5, 2e-5, 4e-5, 8e-5, 1.4e-4, 2.4e-4, 4e-4, 7e-4, 1.2e-3, 2e-3, 4e-3, 8e-3}) {
                 out.push_back({e});
                 out.push_back({-e});
               }
               return out;
             },
         .columns =
             [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const auto y = delayed_rows(r, 0.0, shape[0]);
               for (std::size_t i = 0; i < y.size(); ++i)
                 out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (y[i] - r.F_N[i]);
             },
         .least = 0.6,
         .most = 1.6},
        {.name = "lost_blocks",
         .shape = {{"block_s", "s", -10.0, 10.0, 1e-3, "time of a lost block, by which the output is later from then on; negative: the reference is"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the signal on the other clock"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput& c) {
               return c.block_s != 0.0 ? std::vector<std::vector<double>>{{c.block_s}} : std::vector<std::vector<double>>{};
             },
         .columns =
             [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               out.setZero();
               if (r.lost_blocks.empty()) return;
               const auto y = rows_behind_lost_blocks(r, shape[0]);
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = r.decay[i] * (y[i] - r.F_N[i]); });
             },
         .least = 0.6,
         .most = 1.6}}}};

}  // namespace
}  // namespace forcegate
