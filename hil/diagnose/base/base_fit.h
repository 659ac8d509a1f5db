#pragma once
// S2: the base law at the records' own repeatability.

#include <Eigen/Dense>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Rows of a record that a fit uses: at most `limit`, spread evenly with a fixed jitter.
std::vector<std::size_t> choose_rows(const RecordInput& record, std::size_t limit);

/// Fits the base law with per-record repeatability (b, q by Gauss-Newton at the record's own values, the rest linear)
/// and leaves D(t) in the inputs, the shifts and the row noise in the workspace. Where the maxima do not decay the law becomes static.
/// `beside`: effects that take part in this fit, as what they add is no decay: about the strengths that are written, others at any strength.
void fit_base(Workspace& workspace, unsigned threads = 1, const std::vector<Candidate>& beside = {});

}  // namespace forcegate::diagnose
