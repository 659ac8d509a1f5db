#pragma once
// Effects of the user's own, as equations in the model file, among the candidates: screened, refined and fitted by the
// same machinery as the built-in ones. Their parameters are the shape, a common factor is the strength.

#include <memory>
#include <vector>

#include "hil/base/result.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

/// True once a fit has given the effect's parameters their uncertainties: it is a part of the model then.
bool is_fitted(const UserEffect& effect);

/// Makes a kind of each effect. Error (config) when an equation cannot be read or gives no finite value on the first record.
Result<std::vector<std::unique_ptr<EffectKind>>> make_user_kinds(const std::vector<UserEffect>& effects,
                                                                 const CampaignInput& input);

/// The effect with the candidate's shape and the fitted strength (a parameter named "share"); u of each parameter.
UserEffect with_parameters(const UserEffect& effect, const std::vector<double>& shape, double share,
                           double share_se);

}  // namespace forcegate::diagnose
