#include "hil/diagnose/choose/shares.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/choose/reference_jitter.h"

namespace forcegate::diagnose {

void set_shares(const ResidualChannel& channel, const ScreenResult& result, std::size_t place, const SelectionRules& rules, bool beside_another,
                ChosenEffect& chosen) {
  const double top = chosen.gain;
  // evidence between records counts records; evidence within them counts rows that hang together and needs a scale
  const double temperature = chosen.by_records() ? 1.0 : chosen.between ? 1.5 : 0.03 * std::max(0.0, top) + 6.0;
  constexpr double kOfWhatIsLeft = 3.0;
  double sum = 0.0;
  std::vector<double> weight(result.families.size(), 0.0);
  for (std::size_t k = place; k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    if (chosen.by_records() && !family.kind->traits.between_records) continue;  // what acts within records answers another question
    weight[k] = std::exp(std::max(-200.0, (family.gain - top) / temperature));
    // signatures that differ by less than a form is known to cannot be parted by how well they fit
    if (rules.forms_are_rough && family.kind != chosen.kind && family.gain > 0.6 * top && !family.best.wrong_sign) {
      const double cosine = signature_cosine(channel, result.base, chosen.fit, chosen.columns, family.best.fit,
                                             channel.variants[static_cast<std::size_t>(family.best.variant)].columns);
      const double apart = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), left = std::sqrt(std::max(0.0, 1.0 - chosen.fall));
      // a form that leaves nothing is no rough one
      if (apart < std::min(rules.form_error, kOfWhatIsLeft * left)) weight[k] = 1.0;
    }
    sum += weight[k];
  }
  // unless it outlasts them: what goes on growing moves zeros and gains from record to record as well
  constexpr double kWithin = 40.0, kNearly = 0.7;
  for (std::size_t k = 0; chosen.by_records() && k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    if (family.kind->traits.between_records || !look_alike(*family.kind, *chosen.kind) || family.gain < std::max(kWithin, kNearly * top) || family.best.wrong_sign) continue;
    if (share_of_jitter(channel, result.base, family.best.fit) > kOfJitter) continue;
    if (beside_another && family.best.fall < rules.later_fall && family.best.total_fall < rules.later_total_fall) continue;  // remains of the other's form
    weight[k] = 1.0;
    sum += 1.0;
  }
  for (std::size_t k = 0; k < result.families.size(); ++k) {
    const FamilyScore& family = result.families[k];
    const double share = weight[k] / sum;
    if (family.kind == chosen.kind) chosen.share_of_family = share;
    else if (share > 0.01) chosen.rivals.emplace_back(family.kind->name, share);
  }
}

}  // namespace forcegate::diagnose
