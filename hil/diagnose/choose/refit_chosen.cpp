#include "hil/diagnose/choose/refit_chosen.h"

#include <algorithm>

namespace forcegate::diagnose {

void refit_chosen(const ResidualChannel& channel, const std::vector<int>& carried, Selection& selection) {
  std::vector<int> present = carried;
  for (ChosenEffect& chosen : selection.chosen) {
    add_columns(present, chosen.columns);
    const MixedFit fit = fit_mixed(channel.problem, present, &selection.final, 12, RecordUse::all_records);
    if (!fit.valid) return;
    chosen.fit = fit;
    add_columns(present, family_columns(channel, *chosen.kind));
  }
  const MixedFit final = fit_mixed(channel.problem, present, &selection.final, 12, RecordUse::all_records);
  if (!final.valid) return;
  selection.final = final;
  selection.excess_after = excess_mean_square(channel, final);
}

std::vector<int> columns_beside(const ResidualChannel& channel, const Selection& selection, const ChosenEffect& effect) {
  const std::vector<int> own = columns_of(channel, effect);
  std::vector<int> out = selection.claimed.columns;
  std::erase_if(out, [&](int column) { return std::ranges::find(own, column) != own.end(); });
  return out;
}

}  // namespace forcegate::diagnose
