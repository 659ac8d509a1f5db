#pragma once
// How far the starting model is from the held-out records, without any search: what a diagnosis calls error_before.

#include <optional>
#include <vector>

#include "hil/diagnose/engine.h"

namespace forcegate::diagnose {

/// RMS over the held-out records (over all, left out in turn, where none is), each record weighing the same; V or N.
struct BaseError {
  double own_levels = 0.0;     ///< every record follows with gain, zero and decay of its own
  double common_levels = 0.0;  ///< with its own decay alone: the measure of what acts between records

  double of(bool common) const { return common ? common_levels : own_levels; }
};

struct BaseErrors {
  BaseError output;                ///< of the output at the reference's force
  std::optional<BaseError> force;  ///< of the reference at the force of the rig's law, where the workspace has one
};

/// The law with these columns beside it, from where the search stands: all records, then those to be fitted, since from these alone the spreads
/// may end at another optimum. `forgives`: beside a lead of the output where the reference explains one; notes say so. Not valid where the
/// records do not determine it.
MixedFit law_beside(const Workspace& workspace, const std::vector<int>& columns, bool forgives, std::vector<std::string>& notes);

/// The starting model: the law with what the model holds.
MixedFit base_model(const Workspace& workspace, const EngineOptions& options, std::vector<std::string>& notes);

/// Errors: the records do not determine the starting model.
Result<BaseErrors> base_errors(const Workspace& workspace, const EngineOptions& options);

/// Of every record: RMS of the output with gain, zero and decay of all records, V. Empty where they do not determine the starting model.
std::vector<double> plain_errors_V(const Workspace& workspace, const EngineOptions& options);

}  // namespace forcegate::diagnose
