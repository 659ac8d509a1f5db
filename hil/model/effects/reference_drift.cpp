// Zero drift of the reference cell: warm-up (log t) and wander, additive in newtons, continuous over records.
//   F_ref = F + c d(t), so dU = -g D c d(t) at given F_ref; the same drift appears in F_ref minus the rig's law.
//   d = t/T, (t/T)^2, log(1 + t/tau).  0.5 to 5 % of full scale over hours (own estimate).
// as_rig_shows: d as F_ref minus the rig's law has it, c = -1: a zero that jumps at will is told from the sensor's by two witnesses that agree.
// course_over_rig: the same within records, where the law is a line of each record's own: its mean is lost with the line.

#include <cmath>
#include <utility>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

double campaign_length_s(const CampaignInput& c) {
  double end = 1.0;
  for (const RecordInput& r : c.records) end = std::max(end, r.start_s + r.duration_s);
  return end;
}

EffectForm polynomial() {
  return {.name = "polynomial",
          .shape = {},
          .strength = {{"linear_N", "N", -100.0, 100.0, 0.0, "drift over the campaign"},
                       {"square_N", "N", -100.0, 100.0, 0.0, "curved part of the drift"}},
          .sign = StrengthSign::either,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double T = campaign_length_s(c);
                r.for_each_wanted([&](std::size_t i) {
                  const double t = (r.start_s + r.t_s[i]) / T;
                  out(static_cast<Eigen::Index>(i), 0) = t;
                  out(static_cast<Eigen::Index>(i), 1) = t * t;
                });
              },
          .singles = true};
}

EffectForm warm_up() {
  return {.name = "warm_up",
          .shape = {{"tau_s", "s", 1.0, 1e5, 600.0, "warm-up time"}},
          .strength = {{"c_N", "N", -100.0, 100.0, 0.0, "drift per unit of ln(1 + t/tau)"}},
          .sign = StrengthSign::either,
          .grid =
              [](const CampaignInput&) {
                return std::vector<std::vector<double>>{{60.0}, {600.0}, {3000.0}};
              },
          .columns =
              [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
                r.for_each_wanted([&](std::size_t i) {
                  out(static_cast<Eigen::Index>(i), 0) = std::log1p((r.start_s + r.t_s[i]) / shape[0]);
                });
              }};
}

EffectForm wander() {
  return {.name = "wander",
          .shape = {},
          .strength = {{"k1_N", "N", -100.0, 100.0, 0.0, "half wave over the campaign"},
                       {"k2_N", "N", -100.0, 100.0, 0.0, "one wave"},
                       {"k3_N", "N", -100.0, 100.0, 0.0, "one and a half waves"},
                       {"k4_N", "N", -100.0, 100.0, 0.0, "two waves"},
                       {"k5_N", "N", -100.0, 100.0, 0.0, "two and a half waves"},
                       {"k6_N", "N", -100.0, 100.0, 0.0, "three waves"}},
          .sign = StrengthSign::either,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                const double T = campaign_length_s(c);
                r.for_each_wanted([&](std::size_t i) {
                  for (int k = 1; k <= 6; ++k)
                    out(static_cast<Eigen::Index>(i), k - 1) =
                        std::cos(k * 3.14159265358979 * (r.start_s + r.t_s[i]) / T);
                });
              },
          .bank = true};
}

EffectForm over_rig(std::string name, RigShows after_rig) {
  return {.name = std::move(name),
          .shape = {},
          .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the zero against the rig's law that the output does not follow"}},
          .sign = StrengthSign::negative,
          .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
          .columns =
              [](const CampaignInput&, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                for (std::size_t i = 0; i < r.rig_zero_N.size(); ++i) out(static_cast<Eigen::Index>(i), 0) = r.rig_zero_N[i];
              },
          .least = -1.3,
          .most = -0.7,
          .after_rig = after_rig};
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "reference_drift",
    .side = "reference",
    .channel = EffectChannel::rig,
    .summary = "the zero of the reference cell moves over the campaign, whatever the force",
    .equation = "F_ref = F + c d(t)",
    .source = "warm-up of strain gauge cells; own estimate of size",
    .look_alikes = {"thermal", "creep"},
    .separates =
        "an unloaded zero before and after every record; a third witness: the rig's own law, or the capacitance C_F",
    .needs = {Need::witness},
    .traits = {.between_records = true, .needs_records = true},
    .forms = {polynomial(), warm_up(), wander(), over_rig("as_rig_shows", RigShows::zero_of_records),
              over_rig("course_over_rig", RigShows::course_within_records)}}};

}  // namespace
}  // namespace forcegate
