#include "hil/diagnose/refit/stands_still.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

bool is_still(double before, double after, double se) {
  constexpr double kOfError = 0.02, kOfValue = 1e-3;
  return std::abs(after - before) <= (se > 0.0 ? kOfError * se : kOfValue * std::abs(after));
}

bool are_still(const std::vector<ModelParameter>& before, const std::vector<ModelParameter>& after) {
  return std::ranges::equal(before, after, [](const ModelParameter& a, const ModelParameter& b) { return a.name == b.name && is_still(a.value, b.value, b.se); });
}

}  // namespace

bool stands_still(const Model& before, const Model& after) {
  if (before.law.decays != after.law.decays || before.law.loading_share != after.law.loading_share) return false;
  if (!is_still(before.law.gain_N_per_V, after.law.gain_N_per_V, after.se_gain) || !is_still(before.law.offset_N, after.law.offset_N, after.se_offset)) return false;
  if (after.law.decays && !(is_still(before.law.b_scale, after.law.b_scale, after.se_b_scale) && is_still(before.law.q_scale, after.law.q_scale, after.se_q_scale))) return false;
  const bool library = std::ranges::equal(before.effects, after.effects, [](const ModelEffect& a, const ModelEffect& b) {
    return a.effect == b.effect && a.form == b.form && are_still(a.shape, b.shape) && are_still(a.strength, b.strength);
  });
  return library && std::ranges::equal(before.user_effects, after.user_effects,
                                       [](const UserEffect& a, const UserEffect& b) { return a.name == b.name && are_still(a.parameters, b.parameters); });
}

}  // namespace forcegate::diagnose
