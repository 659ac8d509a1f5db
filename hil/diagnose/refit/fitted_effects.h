#pragma once
// The forms and shapes that a model's effects take on a campaign, each beside all the others: an effect that is fitted before another one is there
// takes that one's part too, and gives it back only where it is fitted again beside it (backfitting, Breiman and Friedman 1985).

#include <string>
#include <utility>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

struct FittedEffects {
  std::vector<MixedFit> chain;  ///< the law alone, then with one effect more each time, at the forms and shapes of the whole
  std::vector<int> variants;    ///< every form that was taken
  std::vector<std::pair<std::string, std::vector<int>>> columns;  ///< of each effect

  const MixedFit& law() const { return chain.front(); }
  const MixedFit& all() const { return chain.back(); }
};

/// One round over `names`, effects of `at` and at most one that is not: where there is one, the others stand as `at` has them (a guess where the
/// workspace moved it), and the new one is chosen beside them. `at`: the model that the workspace was prepared with; `leads`: one of them may
/// take the whole of a lead that a late reference is forgiven else. Errors (config): the records do not determine the law; as best_form.
Result<FittedEffects> fit_effects(Workspace& workspace, const Model& at, const std::vector<std::string>& names, bool leads, unsigned threads,
                                  std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
