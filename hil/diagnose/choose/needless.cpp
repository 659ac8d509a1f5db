#include "hil/diagnose/choose/needless.h"

#include <algorithm>

#include "hil/diagnose/base/left_out.h"
#include "hil/diagnose/choose/refit_chosen.h"

namespace forcegate::diagnose {

void drop_needless(const ResidualChannel& channel, const std::vector<int>& carried, const SelectionRules& rules, Selection& out) {
  bool dropped = false;
  for (std::size_t k = 0; out.chosen.size() >= 2 && k < out.chosen.size();) {
    std::vector<int> without = carried;
    for (std::size_t j = 0; j < out.chosen.size(); ++j)
      // what changes from record to record takes the place of nothing that happens within one
      if (j != k && (out.chosen[k].between || !out.chosen[j].between)) {
        // own columns only for others: a bank is there to soak up remains, not to take the place of another effect
        add_columns(without, out.chosen[j].columns);
        if (look_alike(*out.chosen[j].kind, *out.chosen[k].kind) && !out.chosen[j].seen_in_place)
          add_columns(without, family_columns(channel, *out.chosen[j].kind));
      }
    std::vector<int> with = without;
    add_columns(with, out.chosen[k].columns);
    const MixedFit reduced = fit_mixed(channel.problem, without, &out.final, 12, RecordUse::all_records);
    const MixedFit full = fit_mixed(channel.problem, with, &out.final, 12, RecordUse::all_records);
    if (!reduced.valid || !full.valid) break;
    const double left = excess_mean_square(channel, reduced), kept = excess_mean_square(channel, full);
    // what another effect's form leaves is no measure of this one
    const double its_own = std::min(left, out.chosen[k].fall * out.chosen[k].excess);
    const double lost = full.log_evidence - reduced.log_evidence;
    // so much evidence is that of no other effect, though its strength, beside others that are as large, may be that of some records
    constexpr double kPlain = 100.0;
    const auto leaves_little = [&] { return left - kept < 0.25 * std::max(0.02 * out.excess_before, its_own); };
    const auto helps_none = [&] { return !(out.chosen[k].between || lost > kPlain || cross_fit(channel, reduced, full).helps()); };
    const bool goes = lost < rules.first_gain || (!out.chosen[k].seen_in_place && (leaves_little() || helps_none()));
    if (!out.chosen[k].by_records() && !out.chosen[k].completes_whole && goes) {
      out.refused.push_back({out.chosen[k].kind->name, Refusal::needless, lost});
      out.chosen.erase(out.chosen.begin() + static_cast<std::ptrdiff_t>(k));
      dropped = true;
      k = 0;
    } else {
      out.chosen[k].unique = full.log_evidence - reduced.log_evidence;
      ++k;
    }
  }
  if (dropped) refit_chosen(channel, carried, out);
}

}  // namespace forcegate::diagnose
