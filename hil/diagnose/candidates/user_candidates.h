#pragma once
// Effects of the user's own, as equations in the model file, among the candidates: screened, refined and fitted by the
// same machinery as the built-in ones. A parameter that the whole output is proportional to is the strength, with its own name and unit;
// where there is none and the output is a sum of parts, each proportional to one parameter, all these are; else a common factor "share" is. All
// others are the shape; of several proportional ones the rest keep their values, since the records tell only the product.

#include <memory>
#include <span>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

/// What a shape of the user's own may be: within its bounds, and two decades around the value that was written.
struct Reach {
  double low = 0.0, high = 0.0;
};
Reach reach_of(const ModelParameter& parameter);

/// True once a fit has given the effect's parameters their uncertainties: it is a part of the model then.
bool is_fitted(const UserEffect& effect);

/// Makes a kind of each effect. Error (config) when an equation cannot be read, or gives no finite value on a record at the values written.
Result<std::vector<std::unique_ptr<EffectKind>>> make_user_kinds(const std::vector<UserEffect>& effects,
                                                                 const CampaignInput& input);

/// Error (config) when the effect adds nothing to gain and offset of the law on these records: a fit would say that it is not needed. `kind`: as made of it.
Result<void> check_excited(const UserEffect& effect, const EffectKind& kind, const CampaignInput& input);

/// The effect with a fitted shape and strength and their uncertainties, in the order of the form that was made of it.
UserEffect with_fit(const UserEffect& effect, const EffectForm& form, std::span<const Estimate> shape, std::span<const Estimate> strength);

}  // namespace forcegate::diagnose
