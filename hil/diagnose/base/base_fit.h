#pragma once
// S2: the base law at the records' own repeatability, and the columns of Z that say what a record may have of its own.

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

/// Columns of Z for the chosen rows at the workspace's shifts, each divided by the voltage span.
Eigen::MatrixXd repeatability_columns(const Workspace& workspace, std::size_t record,
                                      const std::vector<std::size_t>& rows);
/// Slow wander as columns of Z from `first` on: half waves cos(k pi t / T) of the record, k = 1 .. count, those longer than a minute; in a block of a
/// recording without their mean, which is the zero's.
void add_waves(const RecordInput& record, const std::vector<std::size_t>& rows, Eigen::Index first, int count, Eigen::MatrixXd& Z);
/// The ordinary lag of a drive behind its command as two columns of Z: (L_tau[C] - C) / scale, tau 30 and 100 ms.
void add_drive_lag(const RecordInput& record, const std::vector<double>& command_N, const std::vector<std::size_t>& rows, double scale,
                   Eigen::Index first, Eigen::MatrixXd& Z);
/// Sets nz, components and priors of the output channel. Without `tells_swing` the gain is that of the cycles: where all records are cyclic with one
/// lowest force, a swing of its own size would take any part of the gain for itself, and zeros make up for it.
void set_repeatability(MixedProblem& problem, bool one_recording, bool zero_wanders, bool tells_swing);
/// Where cyclic records have one lowest force, a swing of its own size is a gain and a zero: static records part them, and where these are left
/// out the prior alone does. What a record is foretold by (MixedProblem::plain_prior_sd) has a prior as wide as the law's own swing with its
/// standard error.
void size_swing(MixedProblem& problem);

}  // namespace forcegate::diagnose
