// Bump at a change of frequency: the output jumps up and returns to the curve it would have followed (Lebosse 2011,
// fig. 8).  dU = g c (1 - D)(F - Fmin) sum_j |ln(f2/f1)| exp(-(t - tj)/tau); second form with the whole swing.

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

EffectForm form(const char* name, bool lost_swing, bool signed_jump) {
  return {.name = name,
          .shape = {{"tau_s", "s", 0.5, 1000.0, 20.0, "time in which the bump fades"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "height, per unit of ln(f2/f1)"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput&) {
                return std::vector<std::vector<double>>{{4.0}, {12.0}, {36.0}, {100.0}};
              },
          .columns =
              [=](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                for (std::size_t i = 0; i < r.rows(); ++i) {
                  double bump = 0.0;
                  for (std::size_t j = 0; j < r.frequency_jumps_s.size(); ++j) {
                    const double since = r.t_s[i] - r.frequency_jumps_s[j];
                    const double height = signed_jump ? r.jump_log_ratio[j] : std::abs(r.jump_log_ratio[j]);
                    if (since >= 0.0) bump += height * std::exp(-since / shape[0]);
                  }
                  const double swing = (lost_swing ? 1.0 - r.decay[i] : 1.0) * (r.F_N[i] - r.F_min_N);
                  out(static_cast<Eigen::Index>(i), 0) = r.dynamic ? bump * swing : 0.0;
                }
              }};
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "frequency_bump",
               .side = "sensor",
               .summary = "after a change of frequency the maxima jump and fade back within a minute",
               .equation = "dU = g c (1 - D)(F - Fmin) |ln(f2/f1)| exp(-(t - tj)/tau)",
               .source = "Lebosse et al. 2011, fig. 8",
               .look_alikes = {"slow_recovery", "contact_loss"},
               .separates = "a switch up, a switch down, and a pause between equal frequencies as control",
               .needs = {},
               .forms = {form("lost_swing", true, false), form("whole_swing", false, false),
                         form("whole_swing_signed", false, true), form("lost_swing_signed", true, true)}}};

}  // namespace
}  // namespace forcegate
