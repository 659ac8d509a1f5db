// Rate-independent hysteresis: friction and delayed re-opening of contacts.
//   dU = g D sum_r c_r (P_r[F] - F),  P_r the play operator of radius r    (Krasnoselskii and Pokrovskii 1989)
//   dU = -g D c z,  dz = dF (1 - sgn(dF z) |z| / z0)                        (Bouc 1967, Wen 1976, n = 1)
//   dU = g D sum_r sum_j c_rj (h_j(P_r[F]) - (h_j(F - r) + h_j(F + r)) / 2),  h_j hinges    (Preisach's plane: weights for half width and
//                                                                                           centre; Krejci 1996)
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

// A loop may be wide here and narrow there, as contacts that close at loads of their own make it: hinges of the plays, less the mean of the
// two branches, so that the loop bends nothing.
constexpr std::array kPreisachRadii = {0.05};
constexpr int kHinges = 16, kPreisach = static_cast<int>(kPreisachRadii.size());

double hinge(const CampaignInput& campaign, int j, double x) {
  return j == 0 ? x : std::max(0.0, x - campaign.lowest_N - campaign.range_N * j / kHinges);
}

std::vector<ParameterSpec> preisach_weights() {
  std::vector<ParameterSpec> out;
  for (int k = 0; k < kPreisach; ++k)
    for (int j = 0; j < kHinges; ++j)
      out.push_back({"w" + std::to_string(k + 1) + "_" + std::to_string(j), "1", -4.0, 4.0, 0.0,
                     "added to the weight of the play of radius " + std::to_string(kPreisachRadii[static_cast<std::size_t>(k)]) +
                         " of the force span above " + std::to_string(j) + "/" + std::to_string(kHinges) + " of it"});
  return out;
}

void preisach(const CampaignInput& campaign, const RecordInput& record, bool kept, ColumnsRef out) {
  for (int k = 0; k < kPreisach; ++k) {
    const double radius = kPreisachRadii[static_cast<std::size_t>(k)] * campaign.range_N;
    Play play = play_at_start(campaign, record, &RecordInput::F_N, radius, 0.0, kept);
    for (std::size_t i = 0; i < record.rows(); ++i) {
      const double F = record.F_N[i], p = play.step(F);
      for (int j = 0; j < kHinges; ++j)
        out(static_cast<Eigen::Index>(i), k * kHinges + j) =
            record.decay[i] * (hinge(campaign, j, p) - 0.5 * (hinge(campaign, j, F - radius) + hinge(campaign, j, F + radius)));
    }
  }
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
        {.name = "preisach",
         .shape = {kPlayKept},
         .strength = preisach_weights(),
         .sign = StrengthSign::either,
         .grid = [](const CampaignInput& c) { return c.generic ? kept_or_not(c) : std::vector<std::vector<double>>{}; },
         .columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                       ColumnsRef out) { preisach(c, r, shape[0] != 0.0, out); },
         .refine = false,
         .last = true},
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
