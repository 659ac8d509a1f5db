// Contact loss: the wheel lifts off where m < A; F_ref stays at zero while the wheel turns on.
//   dF = c max(0, F1 - L),  L the force of the linear rig law, F1 the force at which the contact opens.
// The paper's model assumes m >= A (Lebosse 2011, eq. 2).

#include <algorithm>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "contact_loss",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary = "the contact opens at the bottom of the cycle: F_ref is flat at zero while the wheel moves",
    .equation = "F = L + c max(0, F1 - L)",
    .source = "Lebosse et al. 2011, eq. 2: m >= A is required",
    .look_alikes = {"dead_zone", "spring_nonlinearity"},
    .separates = "the same cycle with a higher mean force",
    .needs = {"witness"},
    .forms = {
        {.name = "hinge",
         .shape = {{"F1_N", "N", -100.0, 100.0, 0.0, "force of the linear law at which the contact opens"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "1: the force stays where it was"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput& c) {
               // far above zero too: the preload that was declared may be that of before the wheel was moved away
               std::vector<std::vector<double>> out;
               for (const double share : {-0.05, 0.0, 0.03, 0.08, 0.16, 0.28})
                 out.push_back({share * c.range_N});
               return out;
             },
         .columns =
             [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               out.setZero();
               if (r.rig_force_N.empty()) return;
               r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = std::max(0.0, shape[0] - r.rig_force_N[i]); });
             },
         // an open contact carries nothing: a slope that is a little less at the bottom is another thing
         .least = 0.35,
         .most = 2.0}}}};

}  // namespace
}  // namespace forcegate
