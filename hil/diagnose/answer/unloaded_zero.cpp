#include "hil/diagnose/answer/unloaded_zero.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/base/plain_number.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

struct Rest {
  double force_N = 0.0;  // what the reference shows at the lowest load of the record
  double zero_N = 0.0;   // of the output
  double load_N() const { return force_N + zero_N; }
};

std::optional<double> lowest_force_N(const RecordInput& r) {
  constexpr double kLowest = 0.02;
  constexpr std::size_t kFewest = 5;
  std::vector<double> force;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) force.push_back(r.F_N[i]);
  if (force.size() < kFewest) return std::nullopt;
  std::ranges::sort(force);
  const std::size_t n = std::max(kFewest, static_cast<std::size_t>(kLowest * static_cast<double>(force.size())));
  return force[n / 2];
}

std::vector<Rest> rests_of(const Workspace& w, const MixedFit& fit) {
  std::vector<Rest> out;
  for (std::size_t k = 0; k < fit.zeta.size(); ++k) {
    const std::optional<double> force_N = lowest_force_N(w.input.records[w.output.record_of[k]]);
    if (!force_N) continue;
    const double gain = fit.zeta[k][0] * w.gain_V_per_N * *force_N / w.output.scale;
    out.push_back({*force_N, (fit.zeta[k][1] + gain) * w.output.scale / w.gain_V_per_N});
  }
  return out;
}

template <class Of>
double spread_of(const std::vector<Rest>& rests, const Of& of) {
  double mean = 0.0, square = 0.0;
  for (const Rest& r : rests) mean += of(r) / static_cast<double>(rests.size());
  for (const Rest& r : rests) square += (of(r) - mean) * (of(r) - mean);
  return std::sqrt(square / std::max(1.0, static_cast<double>(rests.size()) - 1.0));
}

}  // namespace

std::optional<UnloadedZero> unloaded_zero_of_reference(const Workspace& w, const MixedFit& fit) {
  constexpr std::size_t kFewest = 4;
  constexpr double kOfSpread = 0.3, kOfRange = 0.005, kSteps = 3.0;
  if (w.input.single || w.has_rig || w.has_command || w.input.has_capacitance || !fit.valid || w.gain_V_per_N == 0.0) return std::nullopt;
  std::vector<Rest> rests = rests_of(w, fit);
  const std::size_t records = rests.size();
  if (records < kFewest) return std::nullopt;
  const auto zero = [](const Rest& r) { return r.zero_N; };
  const double zeros_N = spread_of(rests, zero);
  // those that come down to the lowest load: what is left unloaded has no lower one
  std::ranges::sort(rests, {}, &Rest::load_N);
  const double lowest_N = rests.front().load_N();
  std::erase_if(rests, [&](const Rest& r) { return r.load_N() > lowest_N + 2.0 * kOfSpread * zeros_N; });
  if (rests.size() < kFewest || 2 * rests.size() < records) return std::nullopt;
  double step_N = 0.0;
  for (const RecordHealth& h : w.health) step_N = std::max(step_N, h.lsb_F_N);
  const double moves_N = spread_of(rests, zero), load_N = spread_of(rests, [](const Rest& r) { return r.load_N(); });
  if (moves_N < std::max(kOfRange * w.input.range_N, kSteps * step_N) || load_N > kOfSpread * moves_N || moves_N < 0.5 * zeros_N) return std::nullopt;
  return UnloadedZero{rests.size(), moves_N};
}

void claim_unloaded_zero(const Workspace& w, const MixedFit& fit, Diagnosis& out) {
  constexpr double kSure = 0.9;
  const EffectKind* kind = EffectRegistry::instance().find("reference_drift");
  const auto claims_it = [](const Finding& f) { return f.claimed() && (f.effect == "reference_drift" || f.between_records); };
  if (kind == nullptr || std::ranges::any_of(out.findings, claims_it)) return;
  const std::optional<UnloadedZero> found = unloaded_zero_of_reference(w, fit);
  if (!found) return;
  Finding drift = finding_about(*kind, w.output);
  drift.form = kUnloadedZero;
  drift.between_records = true;
  drift.probability = kSure;
  drift.parameters.push_back({"zero_sd_N", found->spread_N, found->spread_N / std::sqrt(2.0 * static_cast<double>(found->records) - 2.0), "N"});
  drift.evidence = fmt::format("{} of {} records come down to one and the same output, that of no load, and the reference shows there forces that differ by {} N (standard "
                               "deviation), as the zeros of the records do: it is its own zero that moves, the sensor's would move the output",
                               found->records, fit.zeta.size(), plain_number(found->spread_N));
  std::erase_if(out.findings, [&](const Finding& f) { return f.effect == drift.effect; });
  out.findings.insert(std::ranges::find_if(out.findings, [](const Finding& f) { return !f.claimed(); }), std::move(drift));
  if (out.verdict == DiagnosisVerdict::known) return;
  // what made the answer unknown stands within the records, which a zero of each does not explain
  out.residual_unknown = out.residual_unknown || out.verdict == DiagnosisVerdict::unknown;
  out.verdict = DiagnosisVerdict::known;
}

}  // namespace forcegate::diagnose
