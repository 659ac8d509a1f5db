#include "hil/diagnose/choose/refit_chosen.h"

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

}  // namespace forcegate::diagnose
