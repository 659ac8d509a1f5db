// Contact loss: the wheel lifts off where m < A; F_ref stays at zero while the wheel turns on.
//   dF = c max(0, F1 - L),  L the force of the linear rig law, F1 the force at which the contact opens: one for all records, where the
// declared preload holds, or (at_zero) where the record's own line of F on L meets zero, since a gap may be another in every record.
// The paper's model assumes m >= A (Lebosse 2011, eq. 2).

#include <algorithm>
#include <cmath>

#include "hil/model/effect.h"
#include "hil/trace/static_line.h"

namespace forcegate {
namespace {

// Force of the linear law at which the line of F on L through the closed part of the record meets zero; missing where there is no such line.
double law_at_zero_N(const CampaignInput& c, const RecordInput& r) {
  constexpr double kClosed = 0.05, kLine = 0.9;  // of the span; of the variance
  constexpr double kFewestRows = 50.0;
  StaticLine line;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0 && r.F_N[i] >= kClosed * c.range_N) line.push(r.rig_force_N[i], r.F_N[i]);
  const double LF = line.covariance_VN();
  return line.n() < kFewestRows || !(LF * LF > kLine * line.variance_V2() * line.variance_N2()) ? kMissing : -line.offset_N() / line.gain_N_per_V();
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "contact_loss",
    .side = "rig",
    .channel = EffectChannel::rig,
    .summary = "the contact opens at the bottom of the cycle: F_ref is flat at zero while the wheel moves",
    .equation = "F = L + c max(0, F1 - L)",
    .source = "Lebosse et al. 2011, eq. 2: m >= A is required",
    .look_alikes = {"dead_zone", "spring_nonlinearity"},
    .separates = "the same cycle with a higher mean force",
    .needs = {Need::witness},
    .forms = {
        {.name = "at_zero",
         .shape = {},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "1: the force stays at zero"}},
         .sign = StrengthSign::positive,
         .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
               out.setZero();
               if (r.rig_force_N.empty()) return;
               const double opens_N = law_at_zero_N(c, r);
               if (std::isfinite(opens_N))
                 r.for_each_wanted([&](std::size_t i) { out(static_cast<Eigen::Index>(i), 0) = std::max(0.0, opens_N - r.rig_force_N[i]); });
             },
         .least = 0.35,
         .most = 2.0},
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
