#pragma once
// What the files of this folder share: definitions in C, refusals, and one function for each family of effects.

#include <string>
#include <vector>

#include "hil/model/compensator/c_term.h"

namespace forcegate::c_terms {

std::string array(const std::string& name, const std::vector<double>& values);
std::string constant(const std::string& name, double value);
tl::unexpected<Error> refuse(const std::string& effect, const std::string& why, const std::string& hint);

/// Statements that leave a and b in the state, so that a pole whose state is y and last drive x stands at a + b * drive for a candidate; before the
/// first sample it is settled at the drive. `to_old`, `to_new`: expressions (LowPassWeights); `before`: statements that they need.
std::string prepare_pole(const std::string& id, const std::string& to_old, const std::string& to_new, const std::string& before = "");

/// Statements that add `step` to what two floats hold together, c-><id>_hi and c-><id>_lo with `index` ("[k]" or nothing): a long time
/// constant moves a state by less than the last bit of one.
std::string add_to_pair(const std::string& id, const std::string& index, const std::string& step, const std::string& indent);

inline double shape_of(const ModelEffect& e, std::size_t k) { return e.shape[k].value; }
inline double strength_of(const ModelEffect& e, std::size_t k) { return e.strength[k].value; }

Result<CTerm> creep(const ModelEffect& e, const CTermContext& x);
Result<CTerm> hysteresis(const ModelEffect& e, const CTermContext& x);
Result<CTerm> lag(const ModelEffect& e, const CTermContext& x);
Result<CTerm> thermal(const ModelEffect& e, const CTermContext& x);
Result<CTerm> curve(const ModelEffect& e, const CTermContext& x);
Result<CTerm> dead_zone(const ModelEffect& e, const CTermContext& x);

}  // namespace forcegate::c_terms
