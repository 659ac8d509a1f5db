#pragma once
// S3: the tangent columns of every effect at a grid of shapes, and their Gram matrices.

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Rows of every record that a channel sees.
using RowsOfRecords = std::vector<std::vector<std::size_t>>;
/// Says which rows the Gram matrices will see, so that candidates need no others.
void want_rows(CampaignInput& input, const RowsOfRecords& rows);
/// As many as are enough, spread evenly.
void choose_wanted_rows(CampaignInput& input);
/// The output channel: the candidates that the campaign's channels allow, beside those that stand in the model, `of_model`, and their Gram
/// matrices. `rows`: which it sees; nullptr: as many as are enough, spread evenly.
ResidualChannel output_channel(const Workspace& workspace, unsigned threads, const std::vector<Candidate>& of_model, const ListedOnly* only = nullptr,
                               const RowsOfRecords* rows = nullptr);
/// Makes it the workspace's own.
void build_output_channel(Workspace& workspace, unsigned threads, const std::vector<Candidate>& of_model, const ListedOnly* only = nullptr);
/// Rows of a channel of forces: `fill` writes Z and appends y for the chosen rows of one record; then the candidates' columns, Gram
/// matrices and priors. nz, n_fixed, components and candidates of the channel are set before.
using FillRows = std::function<void(const RecordInput&, const std::vector<std::size_t>&, Eigen::MatrixXd&,
                                    std::vector<double>&)>;
/// `leave_out`: takes rows that say nothing out of those chosen for a record.
using LeaveOutRows = std::function<void(const RecordInput&, std::vector<std::size_t>&)>;
void fill_channel(const Workspace& workspace, ResidualChannel& channel, unsigned threads, const FillRows& fill,
                  const LeaveOutRows& leave_out = {});

/// Writes a candidate's columns at its present shape into the rows and Gram matrices of every record. `beside`: columns of S with which
/// products are wanted while a shape is looked for, those with all others being left as they were; nullptr: all.
void fill_candidate(const CampaignInput& input, ResidualChannel& channel, const Candidate& candidate,
                    unsigned threads, const std::vector<int>* beside = nullptr);

/// Its columns of S.
std::vector<int> columns_of(const Candidate& candidate);

/// Gives the candidate spare columns, not filled yet, and the channel more of these where it has none left; its index.
int place_candidate(ResidualChannel& channel, Candidate candidate);

/// Lists candidates and variants of one channel. `of_model`: what stands in the model, for the forms that act beside it.
void list_candidates(const Workspace& workspace, EffectChannel channel, bool drift_in_output,
                     ResidualChannel& out, const std::vector<std::string>* only = nullptr,
                     const std::vector<Candidate>& of_model = {});

}  // namespace forcegate::diagnose
