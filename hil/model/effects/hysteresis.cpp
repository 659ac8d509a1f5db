// Rate-independent hysteresis: friction and delayed re-opening of contacts.
//   dU = g D sum_r c_r (P_r[F] - F),  P_r the play operator of radius r    (Krasnoselskii and Pokrovskii 1989)
//   dU = -g D c z,  dz = dF (1 - sgn(dF z) |z| / z0)                        (Bouc 1967, Wen 1976, n = 1)
// About 10 % of full scale for FSR (Interlink 400 data sheet); Preisach models are used for the FlexiForce A201.

#include "hil/model/effect.h"
#include "hil/model/play.h"

namespace forcegate {
namespace {

constexpr int kPlays = static_cast<int>(kPlayRadii.size()), kFirst = static_cast<int>(kFirstCurved), kLast = static_cast<int>(kLastCurved);

ParameterSpec weight(const std::string& name, double radius) {
  return {name, "1", -2.0,
          2.0,  0.0, "weight of the play of radius " + std::to_string(radius) + " of the force span"};
}

void play_bank(const CampaignInput& campaign, const RecordInput& record, std::span<const double> shape, ColumnsRef out, bool decayed,
               bool curved) {
  const auto n = record.rows();
  for (int k = 0; k < kPlays; ++k) {
    const double radius = kPlayRadii[static_cast<std::size_t>(k)] * campaign.range_N;
    Play play = play_at_start(campaign, record, &RecordInput::F_N, radius, 0.0, shape[0] != 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      const double F = record.F_N[i], p = play.step(F), D = decayed ? record.decay[i] : 1.0;
      const auto row = static_cast<Eigen::Index>(i);
      out(row, k) = D * (p - F);
      // play of a curved function: loops that are wider at high force
      if (curved && k >= kFirst && k <= kLast) out(row, kPlays + k - kFirst) = D * (p * p - F * F) / campaign.range_N;
    }
  }
}

std::vector<ParameterSpec> bank_weights(bool curved) {
  std::vector<ParameterSpec> out;
  for (std::size_t k = 0; k < kPlayRadii.size(); ++k) out.push_back(weight("w" + std::to_string(k + 1), kPlayRadii[k]));
  if (curved)
    for (std::size_t k = kFirstCurved; k <= kLastCurved; ++k) out.push_back(weight("v" + std::to_string(k + 1), kPlayRadii[k]));
  return out;
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "hysteresis",
    .side = "sensor",
    .summary = "the output differs between loading and unloading by a loop of the same width at any speed",
    .equation = "dU = g D sum_r c_r (P_r[F] - F)",
    .source = "Krasnoselskii and Pokrovskii 1989; Bouc 1967, Wen 1976; Interlink FSR 400 data sheet",
    .look_alikes = {"lag", "delay", "creep", "off_axis", "backlash"},
    .separates = "slow triangles at two speeds a decade apart: the loop keeps its width; nested minor loops",
    .needs = {},
    .traits = {.any_course = true},
    .forms = {
        {.name = "play_bank",
         .shape = {kPlayKept},
         .strength = bank_weights(false),
         .sign = StrengthSign::positive,
         .grid = kept_or_not,
         .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                       ColumnsRef out) { play_bank(c, r, shape, out, true, false); },
         .refine = false,
         .singles = true},
        {.name = "play_bank_undecayed",
         .shape = {kPlayKept},
         .strength = bank_weights(false),
         .sign = StrengthSign::positive,
         .grid = kept_or_not,
         .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                       ColumnsRef out) { play_bank(c, r, shape, out, false, false); },
         .refine = false,
         .singles = true},
        {.name = "play_bank_curved",
         .shape = {kPlayKept},
         .strength = bank_weights(true),
         .sign = StrengthSign::either,
         .grid = kept_or_not,
         .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                       ColumnsRef out) { play_bank(c, r, shape, out, true, true); },
         .refine = false,
         .bank = true},
        {.name = "bouc_wen",
         .shape = {{"z0_N", "N", 1e-3, 100.0, 0.2, "half width of the loop in force"}},
         .strength = {{"c", "1", -2.0, 2.0, 0.0, "share of the force that is held back"}},
         .sign = StrengthSign::positive,
         .grid =
             [](const CampaignInput& c) {
               return std::vector<std::vector<double>>{
                   {0.02 * c.range_N}, {0.06 * c.range_N}, {0.2 * c.range_N}};
             },
         .columns =
             [](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const double z0 = shape[0];
               double z = r.F_N[0] >= z0 ? z0 : r.F_N[0];
               for (std::size_t i = 0; i < r.rows(); ++i) {
                 const double dF = i == 0 ? 0.0 : r.F_N[i] - r.F_N[i - 1];
                 // exact over a step of constant direction: z relaxes towards sgn(dF) z0
                 const double target = dF > 0.0 ? z0 : -z0;
                 if (dF != 0.0) z = target + (z - target) * std::exp(-std::abs(dF) / z0);
                 out(static_cast<Eigen::Index>(i), 0) = -r.decay[i] * z;
               }
             }},
    }}};

}  // namespace
}  // namespace forcegate
