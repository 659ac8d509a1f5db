// Mounting: hardness and curvature of the contacting surface change the gain; one gain for each mounting.
//   dU = g (c W + o R) for all records from number k on, R the force span.  Sensors 20 (2020) 6863.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "mounting",
    .side = "sensor",
    .summary = "gain and zero step between two records and keep their new values",
    .equation = "dU = g (c W + o R) from record k on",
    .source = "Sensors 20 (2020) 6863",
    .look_alikes = {"wear", "thermal", "bias", "slow_recovery"},
    .separates = "the same ramp before and after touching the mounting, and again without touching it",
    .needs = {},
    .forms = {
        {.name = "step",
         .shape = {{"record", "1", 1.0, 1e6, 1.0, "first record of the new mounting"}},
         .strength = {{"c", "1", -0.9, 9.0, 0.0, "relative change of gain"},
                      {"o", "1", -1.0, 1.0, 0.0, "change of zero, share of the force span"}},
         .sign = StrengthSign::either,
         .grid =
             [](const CampaignInput& c) {
               std::vector<std::vector<double>> out;
               for (std::size_t k = 1; k < c.records.size(); ++k) out.push_back({static_cast<double>(k)});
               return out;
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const bool after = static_cast<double>(r.index) >= shape[0];
               for (std::size_t i = 0; i < r.rows(); ++i) {
                 out(static_cast<Eigen::Index>(i), 0) = after ? r.base_force_N(i) : 0.0;
                 out(static_cast<Eigen::Index>(i), 1) = after ? c.range_N : 0.0;
               }
             },
         .refine = false,
         .singles = true}}}};

}  // namespace
}  // namespace forcegate
