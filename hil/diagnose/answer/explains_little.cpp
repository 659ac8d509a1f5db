#include "hil/diagnose/answer/explains_little.h"

#include <algorithm>
#include <cmath>

#include "hil/base/quantile.h"
#include "hil/diagnose/answer/wide_scatter.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/base/mixed_model.h"

namespace forcegate::diagnose {

namespace {

constexpr double kMostLeft = 0.75;  // of the RMS: over half of the mean square
constexpr double kHardlyLess = 0.93;

struct LeftOver {
  double rms = 0.0;         // of the channel's scale
  double log_factor = 0.0;  // mean over records of log(rms / noise): a few noisy records must not hide what the others show
  std::vector<double> square, noise;  // of each record that counts
};

// Over all records, an effect may show in none of those that judge; but those where hum is left.
LeftOver left_over(const ResidualChannel& channel, const MixedFit& fit, const MixedFit& base, const std::vector<char>& of_hum, JudgedBy by) {
  const std::vector<double> square = by == JudgedBy::whole ? fit.adapted : leave_one_out(channel.problem, fit, &base).adapted;
  LeftOver out;
  double n = 0.0;
  for (std::size_t k = 0; k < square.size(); ++k) {
    if (of_hum[k] != 0) continue;
    const RecordGram& record = channel.problem.records[k];
    out.square.push_back(square[k]);
    out.noise.push_back(record.allowed_variance + record.smoothed_variance);
    out.rms += square[k];
    out.log_factor += 0.5 * std::log(std::max(1e-9, square[k] / out.noise.back()));
    n += 1.0;
  }
  n = std::max(n, 1.0);
  out.rms = std::sqrt(out.rms / n);
  out.log_factor /= n;
  return out;
}

// The error of all, and that of the typical record that stood far above the noise: one record may have a fault of its own.
bool leaves_most_of(const LeftOver& before, const LeftOver& after, double most) {
  if (!(after.rms > most * before.rms)) return false;
  double log_ratio = 0.0, n = 0.0;
  for (std::size_t k = 0; k < before.square.size(); ++k) {
    if (!(before.square[k] > kFarAboveNoise * kFarAboveNoise * before.noise[k])) continue;
    log_ratio += 0.5 * std::log(std::max(1e-9, after.square[k] / before.square[k]));
    n += 1.0;
  }
  return !(log_ratio < n * std::log(most));
}

double allowed_square(const LeftOver& left) {
  double sum = 0.0;
  for (const double noise : left.noise) sum += noise;
  return sum / std::max(1.0, static_cast<double>(left.noise.size()));
}

// Median over the records that stood visibly above the noise of the share of their mean square beyond it that is left: one record may have a fault of its own.
double typical_share_left(const LeftOver& before, const LeftOver& after, double visible) {
  std::vector<double> share;
  for (std::size_t k = 0; k < before.square.size(); ++k)
    if (before.square[k] > visible * visible * before.noise[k]) share.push_back((after.square[k] - after.noise[k]) / (before.square[k] - before.noise[k]));
  return share.empty() ? 0.0 : quantile(std::move(share), 0.5);
}

// Near the noise all forms of a family take up whatever is left, and say nothing of it: the claim itself has to explain it. Far above it a form that
// is a little wrong leaves as much.
bool leaves_much_of(const LeftOver& before, const LeftOver& after) {
  constexpr double kVisible = 1.3, kMuch = 0.3, kOfTypical = 0.2;  // of the noise; of the mean square beyond it
  const double allowed = allowed_square(after), left = after.rms * after.rms;
  const bool is_near = left > kVisible * kVisible * allowed && left < kFarAboveNoise * kFarAboveNoise * allowed;
  return is_near && left - allowed > kMuch * (before.rms * before.rms - allowed) && typical_share_left(before, after, kVisible) > kOfTypical;
}

// Nothing else is claimed that may leave it: bad samples, what acts between records.
bool is_all_that_is_claimed(const Selection& selection, const std::vector<Finding>& findings) {
  return std::ranges::none_of(findings, [](const Finding& f) { return f.claimed() && (f.of_samples() || f.of_reference()); }) &&
         std::ranges::none_of(selection.chosen, [](const ChosenEffect& c) { return c.between; });
}

bool is_claim_of(const ChosenEffect& chosen, const Finding& f) { return f.effect == chosen.kind->name && !f.of_samples() && f.claimed(); }

// True when there is one.
bool withdraw_all(const Selection& selection, std::vector<Finding>& findings) {
  bool out = false;
  for (const ChosenEffect& c : selection.chosen)
    for (Finding& f : findings)
      if (is_claim_of(c, f)) out |= f.limit(kWithdrawn, "it leaves much of the error, well above the noise");
  return out;
}

}  // namespace

bool withdraw_what_explains_little(const ResidualChannel& channel, const Selection& selection, const Remainder& rest, JudgedBy by,
                                   std::vector<Finding>& findings) {
  constexpr double kMostOfFamily = 0.36, kBesideRaw = 0.45;  // the same of all forms: an eighth; a fifth beside claims about raw samples
  constexpr double kInAnyCase = 8.0;                         // of the instruments' noise
  const bool remains = rest.beside_claims;
  const LeftOver before = left_over(channel, selection.base, selection.base, rest.of_hum, by),
                after = left_over(channel, selection.claimed, selection.base, rest.of_hum, by);
  // what takes hardly anything of what stands far above the noise is none of its names, whatever all its forms together take up
  const bool hardly_helps = after.rms > kFarAboveNoise * allowed_rms(channel) && leaves_most_of(before, after, kHardlyLess);
  if (hardly_helps && channel.signs_known && is_all_that_is_claimed(selection, findings) && withdraw_all(selection, findings)) return true;
  const double above = remains ? kFarAboveNoise : kInAnyCase;
  // what the samples themselves have named, such as spikes, is left here too
  const bool named = std::ranges::any_of(findings, [](const Finding& f) { return f.of_samples() && f.claimed(); });
  const bool far_above = after.rms > above * allowed_rms(channel) || (!named && after.log_factor > std::log(above));
  if (!far_above) return leaves_much_of(before, after) && channel.signs_known && is_all_that_is_claimed(selection, findings) && withdraw_all(selection, findings);
  const bool leaves_most = leaves_most_of(before, after, kMostLeft);
  // of another machine the forms of the library are rough, and the right one leaves much as well
  const bool rough = !channel.signs_known;
  const double of_family = named ? kBesideRaw : kMostOfFamily;
  if (!(selection.excess_after > of_family * of_family * selection.excess_before)) return false;
  const auto of_course = [&](const ChosenEffect& c) { return !c.between && (leaves_most || (remains && c.kind->traits.any_course && !rough)); };
  const bool withdrawn = std::ranges::any_of(selection.chosen, [&](const ChosenEffect& c) {
    return of_course(c) && std::ranges::any_of(findings, [&](const Finding& f) { return is_claim_of(c, f); });
  });
  if (!withdrawn) return false;
  // what was chosen beside a form that is wrong was chosen by what that form leaves
  for (const ChosenEffect& c : selection.chosen)
    for (Finding& f : findings)
      if (!c.between && is_claim_of(c, f)) {
        f.limit(kWithdrawn, of_course(c) ? "it leaves too much of the error, far above the noise"
                                         : "what stands beside it leaves too much of the error, far above the noise");
      }
  return true;
}

void withdraw_drifts_beside_wide_gains(const ResidualChannel& channel, const Selection& selection, std::vector<Finding>& findings) {
  if (!selection.claimed.valid || !(std::sqrt(selection.claimed.variance[channel.problem.component_of_z[0]]) > kFarGain)) return;
  for (const ChosenEffect& c : selection.chosen) {
    if (!c.between || c.kind->name != "reference_drift" || !(c.error_after > kMostLeft * c.error_before)) continue;
    for (Finding& f : findings)
      if (is_claim_of(c, f)) f.limit(kWithdrawn, "the gains of the records scatter widely beside it, and move their zeros too");
  }
}

}  // namespace forcegate::diagnose
