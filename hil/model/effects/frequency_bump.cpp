// Bump at a change of frequency: the output jumps up and returns to the curve it would have followed (Lebosse 2011,
// fig. 8).  dU = g c (1 - D)(F - Fmin) sum_j h_j exp(-(t - tj)/tau), h_j = |ln(f2/f1)|, ln(f2/f1), or 1: the figure has one change and
// does not tell. Further forms with the whole swing.

#include <cmath>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

enum class Height { of_ratio, of_signed_ratio, equal };

double height_of(double log_ratio, Height height) {
  return height == Height::equal ? 1.0 : height == Height::of_signed_ratio ? log_ratio : std::abs(log_ratio);
}

EffectForm form(const char* name, bool lost_swing, Height height) {
  return {.name = name,
          .shape = {{"tau_s", "s", 0.5, 1000.0, 20.0, "time in which the bump fades"}},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, height == Height::equal ? "height" : "height, per unit of ln(f2/f1)"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput&) {
                return std::vector<std::vector<double>>{{4.0}, {12.0}, {36.0}, {100.0}};
              },
          .columns =
              [=](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                r.for_each_wanted([&](std::size_t i) {
                  double bump = 0.0;
                  for (std::size_t j = 0; j < r.frequency_jumps_s.size(); ++j) {
                    const double since = r.t_s[i] - r.frequency_jumps_s[j];
                    if (since >= 0.0) bump += height_of(r.jump_log_ratio[j], height) * std::exp(-since / shape[0]);
                  }
                  const double swing_N = r.F_N[i] - (r.dynamic ? r.F_min_N : r.jumps_F_min_N);
                  out(static_cast<Eigen::Index>(i), 0) = bump * (lost_swing ? 1.0 - r.decay[i] : 1.0) * swing_N;
                });
              }};
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "frequency_bump",
               .side = "sensor",
               .summary = "after a change of frequency the maxima jump and fade back within a minute",
               .equation = "dU = g c (1 - D)(F - Fmin) h exp(-(t - tj)/tau), h = |ln(f2/f1)|, ln(f2/f1) or 1",
               .source = "Lebosse et al. 2011, fig. 8",
               .look_alikes = {"slow_recovery", "contact_loss"},
               .separates = "a switch up, a switch down, and a pause between equal frequencies as control",
               .needs = {},
               .forms = {form("lost_swing", true, Height::of_ratio), form("whole_swing", false, Height::of_ratio),
                         form("whole_swing_signed", false, Height::of_signed_ratio), form("lost_swing_signed", true, Height::of_signed_ratio),
                         form("lost_swing_equal", true, Height::equal), form("whole_swing_equal", false, Height::equal)}}};

}  // namespace
}  // namespace forcegate
