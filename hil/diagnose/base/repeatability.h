#pragma once
// What a record may have of its own beside the base law, its repeatability: columns of Z, their priors, and what they make of its decay.

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

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
/// Whether the records say more of the swing than its prior does.
bool tells_swing(const MixedFit& fit);
/// By how much the course of record `k` of the fit bends away from the law's exponential `since_s` after the start of its excitation, share of the swing.
double bend_of(const MixedFit& fit, std::size_t k, double since_s);
/// RMS of the slow wander of the zero in record `k` of the fit, of the channel's scale, where the record is whole: the waves are orthogonal over it; 0 in
/// records of less than a minute.
double wander_of(const MixedFit& fit, std::size_t k);
/// The same over its rows: of a block of a recording, which has a part of each wave, and strengths that cancel each other are large there.
double wander_on_rows(const ResidualChannel& channel, const MixedFit& fit, std::size_t k);
/// From its lowest to its highest value in the record, which is whole.
double wander_range_of(const MixedFit& fit, std::size_t k);
/// Multiplies the swing of record `k` of the fit as that fit does: D(t) by the law (in record.decay), a swing of its own size, and the bend of its course
/// away from one exponential, all over its gain. What a lag or a shift in time adds decays as the signal does.
void follow_course(const MixedFit& fit, std::size_t k, double loading_share, RecordInput& record);

}  // namespace forcegate::diagnose
