#include "hil/diagnose/choose/partner.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/candidates/spare_room.h"
#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/refine.h"

namespace forcegate::diagnose {

namespace {

// A family is in the model with all its forms.
std::vector<int> with_family(const ResidualChannel& channel, std::vector<int> columns, const FamilyScore& one) {
  add_columns(columns, columns_of(channel, one.best.variant));
  add_columns(columns, family_columns(channel, *one.kind));
  return columns;
}

// All families beside it.
ScreenResult screen_beside(const ResidualChannel& channel, const std::vector<int>& columns, std::vector<std::string> taken, const FamilyScore& one, unsigned threads) {
  taken.push_back(one.kind->name);
  return screen(channel, columns, taken, &one.best.fit, threads);
}

}  // namespace

std::optional<Partner> partner_of(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& present,
                                  const std::vector<std::string>& taken, const ScreenResult& result, const FamilyScore& first,
                                  const SelectionRules& rules, unsigned threads) {
  constexpr std::size_t kMost = 2;
  constexpr double kTogether = 0.9, kOfLookAlikes = 0.95;  // of what is left
  const double excess = excess_mean_square(channel, result.base);
  Partner out;
  const std::vector<int> columns_of_base = with_family(channel, present, first);
  out.beside = screen_beside(channel, columns_of_base, taken, first, threads);
  if (!out.beside.base.valid) return std::nullopt;
  for (out.place = 0; out.place < std::min(kMost, out.beside.families.size()); ++out.place) {
    FamilyScore& second = out.beside.families[out.place];
    const bool alike = look_alike(*first.kind, *second.kind), are_of_time = first.kind->traits.timing && second.kind->traits.timing;
    if (second.kind->traits.between_records || (alike && are_of_time) || second.best.wrong_sign || second.gain < rules.later_gain) continue;
    SpareRoom room(channel);
    refine_family(input, channel, columns_of_base, out.beside.base, second, threads);
    out.chosen = as_chosen(input, channel, out.beside.base, second, rules);
    if (objection(channel, out.beside, second, out.chosen, {}, 0.0, rules).why != Refusal::none) continue;
    const ScreenResult without = screen_beside(channel, with_family(channel, present, second), taken, second, threads);
    if (!without.base.valid || without.families.empty()) continue;
    const FamilyScore& again = without.families.front();
    const ChosenEffect beside_second = as_chosen(input, channel, without.base, again, rules);
    const double removed = std::sqrt(std::max(1e-18, excess - excess_mean_square(channel, without.base)));
    if (again.kind != first.kind || objection(channel, without, again, beside_second, {out.chosen}, removed, rules).why != Refusal::none ||
        excess_mean_square(channel, again.best.fit) >= (1.0 - (alike ? kOfLookAlikes : kTogether)) * excess)
      continue;
    room.keep();
    return out;
  }
  return std::nullopt;
}

}  // namespace forcegate::diagnose
