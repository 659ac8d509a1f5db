#include "hil/diagnose/choose/reconsider.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/refit_chosen.h"
#include "hil/diagnose/choose/shares.h"

namespace forcegate::diagnose {

namespace {

constexpr double kAlone = 0.95;  // share that leaves no rival worth asking again

double removed_rms(const ChosenEffect& e) { return std::sqrt(std::max(1e-18, e.fall * e.excess)); }

}  // namespace

void reconsider(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& carried, const std::vector<std::string>& skip,
                const SelectionRules& rules, unsigned threads, Selection& out) {
  bool changed = false;
  for (std::size_t k = 0; out.chosen.size() >= 2 && k < out.chosen.size(); ++k) {
    ChosenEffect& place = out.chosen[k];
    if (place.between || place.share_of_family > kAlone) continue;
    const std::vector<int> present = columns_beside(channel, carried, out.chosen, place);
    std::vector<ChosenEffect> others;
    double removed = 0.0;
    for (std::size_t j = 0; j < out.chosen.size(); ++j) {
      if (j == k) continue;
      others.push_back(out.chosen[j]);
      if (!out.chosen[j].between) removed = std::max(removed, removed_rms(out.chosen[j]));
    }
    std::vector<std::string> compete = {place.kind->name};
    for (const auto& [name, share] : place.rivals) compete.push_back(name);
    std::vector<std::string> not_asked = families_but(channel, compete);
    not_asked.insert(not_asked.end(), skip.begin(), skip.end());
    for (const ChosenEffect& other : others) not_asked.push_back(other.kind->name);
    ScreenResult again = screen(channel, present, not_asked, &out.final, threads);
    if (!again.base.valid || again.families.empty()) continue;
    refine_leaders(input, channel, present, again, threads);
    std::size_t at = 0;
    while (at < again.families.size() && (again.families[at].best.wrong_sign || again.families[at].kind->traits.between_records)) ++at;
    if (at == again.families.size()) continue;
    ChosenEffect better = as_chosen(input, channel, again.base, again.families[at], rules);
    if (better.kind != place.kind) {
      const Objection against = objection(channel, again, again.families[at], better, others, removed, rules);
      if (against.why != Refusal::none) continue;
      better.stands_out = against.stands_out;
    }
    set_shares(channel, again, at, rules, !others.empty(), better);
    if (better.kind == place.kind) {
      // how it entered stays what it was judged by
      better.gain = place.gain;
      better.fall = place.fall;
      better.excess = place.excess;
      better.stands_out = place.stands_out;
    }
    changed = changed || better.variant != place.variant;
    place = std::move(better);
  }
  if (changed) refit_chosen(channel, carried, out);
}

}  // namespace forcegate::diagnose
