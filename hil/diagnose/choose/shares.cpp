#include "hil/diagnose/choose/shares.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/choose/probability.h"
#include "hil/diagnose/choose/reference_jitter.h"

namespace forcegate::diagnose {

namespace {

constexpr double kTold = 0.01;  // a rival's share

// ln of a rival's weight where levels of records chose: their evidence, the prior of a cause that nobody recorded, and what the rows within
// the records say of the same cause.
double log_weight_of_levels(const FamilyScore& chosen, const FamilyScore& rival, const SelectionRules& rules) {
  const auto shown = [&](const FamilyScore& f) { return f.records.within < rules.first_gain ? 0.0 : f.records.within; };
  const double rows = (shown(rival) - shown(chosen)) / nats_of_a_factor(std::max(shown(rival), shown(chosen)));
  return rival.records.gain + rival.records.prior - chosen.records.gain - chosen.records.prior + rows;
}

// The same where signatures within the records do not part them: levels may.
double log_weight_of_look_alike(const FamilyScore& chosen, const FamilyScore& rival, const SelectionRules& rules) {
  if (!chosen.records.valid || chosen.records.gain < rules.between_gain) return 0.0;
  return std::min(0.0, (rival.records.valid ? std::max(0.0, rival.records.gain) : 0.0) - chosen.records.gain);
}

}  // namespace

double least_apart(const SelectionRules& rules, double fall) {
  constexpr double kOfWhatIsLeft = 3.0;
  return std::min(rules.form_error, kOfWhatIsLeft * std::sqrt(std::max(0.0, 1.0 - fall)));
}

void set_shares(const ResidualChannel& channel, const ScreenResult& result, std::size_t place, const SelectionRules& rules, bool beside_another,
                ChosenEffect& chosen) {
  const double top = chosen.gain;
  const FamilyScore& leader = result.families[place];
  const double temperature = nats_of_a_factor(top);
  double sum = 0.0;
  std::vector<double> weight(result.families.size(), 0.0);
  for (std::size_t k = 0; k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    if (chosen.by_records()) {
      // what acts within records answers another question; what was turned down for its rows has not been asked for its levels
      if (!family.records.valid || (k < place && asks_between_records(family))) continue;
      weight[k] = std::exp(std::max(-200.0, log_weight_of_levels(leader, family, rules)));
      sum += weight[k];
      continue;
    }
    if (k < place) continue;
    weight[k] = std::exp(std::max(-200.0, (family.gain - top) / temperature));
    // signatures that differ by less than a form is known to cannot be parted by how well they fit
    if (rules.forms_are_rough && family.kind != chosen.kind && family.gain > 0.6 * top && !family.best.wrong_sign) {
      const double cosine = signature_cosine(channel, result.base, chosen.fit, chosen.columns, family.best.fit,
                                             columns_of(channel, family.best.variant));
      const double apart = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
      if (apart < least_apart(rules, chosen.fall)) weight[k] = std::exp(log_weight_of_look_alike(leader, family, rules));
    }
    weight[k] *= std::exp(log_prior(*family.kind, rules) - log_prior(*chosen.kind, rules));
    sum += weight[k];
  }
  // unless it outlasts them: what goes on growing moves zeros and gains from record to record as well, but not with what was recorded
  constexpr double kWithin = 40.0, kNearly = 0.7;
  const bool told_by_levels = candidate_of(channel, chosen.variant).form->cause.of_record != nullptr || chosen.records.same_strength;
  for (std::size_t k = 0; chosen.by_records() && k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    if (family.kind->traits.between_records || !look_alike(*family.kind, *chosen.kind) || family.gain < std::max(kWithin, kNearly * top) || family.best.wrong_sign) continue;
    if (share_of_jitter(channel, result.base, family.best.fit) > kOfJitter) continue;
    if (beside_another && family.best.fall < rules.later_fall && family.best.total_fall < rules.later_total_fall) continue;  // remains of the other's form
    weight[k] = told_by_levels ? std::exp(log_weight_of_look_alike(leader, family, rules)) : 1.0;
    sum += weight[k];
  }
  for (std::size_t k = 0; k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    const double share = weight[k] / sum;
    if (family.kind == chosen.kind) chosen.share_of_family = share;
    else if (share > kTold) chosen.rivals.emplace_back(family.kind->name, share);
  }
}

void share_with_idle(const std::vector<ChosenEffect>& idle, Selection& selection) {
  for (ChosenEffect& chosen : selection.chosen) {
    for (const ChosenEffect& other : idle) {
      if (!chosen.between || !other.between || !look_alike(*other.kind, *chosen.kind)) continue;
      const double temperature = chosen.by_records() ? 1.0 : nats_of_a_factor(std::max(chosen.gain, other.gain));
      const double share = 1.0 / (1.0 + std::exp(std::clamp((chosen.gain - other.gain) / temperature, -200.0, 200.0)));
      chosen.share_of_family *= 1.0 - share;
      if (share > kTold) chosen.rivals.emplace_back(other.kind->name, share);
    }
  }
}

}  // namespace forcegate::diagnose
