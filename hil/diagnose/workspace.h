#pragma once
// What the steps of a diagnosis share: inputs, raw health, the base law at the records' own repeatability, candidate
// signatures and their Gram matrices.

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/mixed_model.h"
#include "hil/diagnose/raw_health.h"
#include "hil/model/base_law.h"
#include "hil/model/effect.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

/// One set of columns of one effect at one shape.
struct Candidate {
  const EffectKind* kind = nullptr;
  const EffectForm* form = nullptr;
  std::vector<double> shape;
  int first = 0, count = 0;  ///< columns of S
  bool is_read = true;       ///< false: nothing reads its columns, they stay zero
};

/// What a channel lists when it does not list everything.
struct ListedOnly {
  std::vector<std::string> families;
  std::function<bool(const Candidate&)> is_read;  ///< empty: all of them are
};

/// A choice that competes: a candidate's columns, or one of them alone.
struct Variant {
  int candidate = 0;
  std::vector<int> columns;
};

/// Chosen rows of one record, as the Gram matrix saw them.
struct RecordRows {
  std::vector<std::size_t> row;
  Eigen::MatrixXd matrix;  ///< rows x (nz + ns + 1)
};

struct RecordShift {
  double log_b = 0.0, log_q = 0.0;
};

struct ResidualChannel {
  MixedProblem problem;
  std::vector<RecordRows> rows;        ///< per record, in the order of problem.records
  std::vector<std::size_t> record_of;  ///< index into CampaignInput::records
  std::vector<Candidate> candidates;
  std::vector<Variant> variants;
  bool signs_known = true;  ///< false: not a sensor of the library's kind, strengths may have either sign
  double gain_of_unit =
      1.0;  ///< entry of the gain's column at a unit of newtons over that of a candidate's column
  double column_factor = 1.0;  ///< newtons of a column to its entry in the matrix
  int first_spare = 0;         ///< columns of S from here on are free for refined shapes
  double scale = 1.0;          ///< y and columns are divided by this (V or N)
  std::string unit = "V";  ///< of the output: that of its column
};

/// RMS over the records of what the declared instruments may leave, share of the channel's scale.
double allowed_rms(const ResidualChannel& channel);

struct Workspace {
  CampaignInput input;
  std::vector<RecordHealth> health;  ///< per record; the parts of one recording share that of its samples
  std::vector<HealthClaim> raw_claims;  ///< what the samples show before any fit
  HealthScales scales;
  std::vector<std::unique_ptr<EffectKind>> user_kinds;  ///< effects of the user's own, beside the registry
  BaseLaw law;
  bool zero_wanders = true;         ///< EngineOptions
  double gain_V_per_N = 2.0;        ///< slope of the static law at the current fit
  std::vector<RecordShift> shifts;  ///< per record
  std::vector<double> noise_V;      ///< row noise of U at given F_ref, errors in variables included
  std::vector<double> white_V;      ///< its white part alone
  std::vector<double> smoothed_V;   ///< what smoothing leaves of the noise of F
  ResidualChannel output, rig, command;
  bool has_command = false;
  bool has_rig = false;
  std::vector<double> rig_slope_N;  ///< per record: newtons a unit of 1 - cos th; 0 without an angle
  bool rig_sees_zero =
      false;  ///< the rig's own law has one zero for all records: a drift of the reference shows beside it
  JudgedBy judges = JudgedBy::heldout;
};

/// Rows of a record that a fit uses: at most `limit`, spread evenly with a fixed jitter.
std::vector<std::size_t> choose_rows(const RecordInput& record, std::size_t limit);

// S2 ------------------------------------------------------------------------------------------------------------
/// Fits the base law with per-record repeatability (b, q by Gauss-Newton at the record's own values, the rest linear)
/// and leaves D(t) in the inputs, the shifts and the row noise in the workspace.
void fit_base(Workspace& workspace, unsigned threads = 1);

/// Columns of Z for the chosen rows at the workspace's shifts, each divided by the voltage span.
Eigen::MatrixXd repeatability_columns(const Workspace& workspace, std::size_t record,
                                      const std::vector<std::size_t>& rows);
/// Slow wander as columns of Z from `first` on: half waves cos(k pi t / T) of the record, k = 1 .. count, those longer than a minute.
void add_waves(const RecordInput& record, const std::vector<std::size_t>& rows, Eigen::Index first, int count, Eigen::MatrixXd& Z);
/// The ordinary lag of a drive behind its command as two columns of Z: (L_tau[C] - C) / scale, tau 30 and 100 ms.
void add_drive_lag(const RecordInput& record, const std::vector<double>& command_N, const std::vector<std::size_t>& rows, double scale,
                   Eigen::Index first, Eigen::MatrixXd& Z);
/// Whether a decay of the swing, of any rate and depth, explains most of what a straight line leaves of the record.
bool decays_by_itself(const RecordInput& record);
/// Mean square, V^2, that a straight line whose slope decays from the record's onset on leaves of it, at the best rate and depth.
double left_by_decay(const RecordInput& record);
/// Sets nz, components and priors of the output channel.
void set_repeatability(MixedProblem& problem, bool one_recording, bool zero_wanders);

// S3 ------------------------------------------------------------------------------------------------------------
/// Says which rows the Gram matrices will see, so that candidates need no others.
void choose_wanted_rows(CampaignInput& input);
/// Lists the candidates that the campaign's channels allow and builds the Gram matrices of the output channel.
/// `of_model`: beside them, those that stand in the model.
void build_output_channel(Workspace& workspace, unsigned threads, const std::vector<Candidate>& of_model, const ListedOnly* only = nullptr);
/// The same for F_ref against angle or command; sets has_rig.
void build_rig_channel(Workspace& workspace, unsigned threads);

/// What the drive makes of a command; sets has_command. After build_rig_channel.
void build_command_channel(Workspace& workspace, unsigned threads);

/// Rows of a channel of forces: `fill` writes Z and appends y for the chosen rows of one record; then the candidates' columns, Gram
/// matrices and priors. nz, n_fixed, components and candidates of the channel are set before.
using FillRows = std::function<void(const RecordInput&, const std::vector<std::size_t>&, Eigen::MatrixXd&,
                                    std::vector<double>&)>;
void fill_channel(const Workspace& workspace, ResidualChannel& channel, unsigned threads,
                  const FillRows& fill);

/// Fills rig_force_N of the records with a witness and lists them: by the declared geometry and one stiffness for all
/// where it is known (then the zero of the reference shows), else by each record's own line.
void find_rig_law(Workspace& workspace, std::vector<std::size_t>& records);

/// Writes a candidate's columns at its present shape into the rows and Gram matrices of every record.
void fill_candidate(const CampaignInput& input, ResidualChannel& channel, const Candidate& candidate,
                    unsigned threads);

/// Gives the candidate spare columns, not filled yet; -1 when there is no room.
int place_candidate(ResidualChannel& channel, Candidate candidate);

/// A copy of the candidate in spare columns, to be moved to other shapes; -1 when there is no room.
int copy_candidate(const CampaignInput& input, ResidualChannel& channel, int candidate, unsigned threads);

/// Lists candidates and variants of one channel.
void list_candidates(const Workspace& workspace, EffectChannel channel, bool drift_in_output,
                     ResidualChannel& out, const std::vector<std::string>* only = nullptr);

}  // namespace forcegate::diagnose
