#pragma once
// What the steps of a diagnosis share: inputs, raw health, the base law at the records' own repeatability, candidate
// signatures and their Gram matrices.

#include <Eigen/Dense>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hil/diagnose/base/mixed_model.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/raw/edges.h"
#include "hil/diagnose/raw/health_claims.h"
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
  bool of_model = false;     ///< the model has it already, at the shape of its file
  bool is_guess = false;     ///< of_model, and no parameter has a standard error: no fit has estimated it
  std::vector<double> written = {};  ///< of_model: strengths as the file writes them, where the prior of its columns stands

  bool owns(int column) const { return column >= first && column < first + count; }
};

/// Whether its columns change gain or zero from record to record: it is judged by these.
inline bool moves_levels(const Candidate& c) {
  return (c.kind->traits.between_records && c.form->after_rig != RigShows::course_within_records) || c.form->outlasts;
}

/// What a channel lists when it does not list everything.
struct ListedOnly {
  std::vector<std::string> families;
  std::function<bool(const Candidate&)> is_read;  ///< empty: all of them are
};

/// A choice that competes: a candidate's columns, or one of them alone.
struct Variant {
  int candidate = 0;
  std::vector<int> columns;
  bool of_levels_alone = false;  ///< what the rows within the records hold of it something else shows better
};

/// Chosen rows of one record, as the Gram matrix saw them.
struct RecordRows {
  std::vector<std::size_t> row;
  Eigen::MatrixXd matrix;  ///< rows x (nz + ns + 1)
};

struct RecordShift {
  double log_b = 0.0, log_q = 0.0;
};

/// What a channel knows beside its numbers: what competes in it, and in which units.
struct ChannelFacts {
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
  ShownIn shown_in = ShownIn::output;  ///< what is found in it
};

struct ResidualChannel : ChannelFacts {
  MixedProblem problem;
  std::vector<RecordRows> rows;  ///< per record, in the order of problem.records
  Eigen::VectorXd taken_off;     ///< strengths of columns of S that y has lost (choose/reference_latency.h); empty: none
};

/// Whose columns a variant takes.
inline const Candidate& candidate_of(const ChannelFacts& channel, int variant) {
  return channel.candidates[static_cast<std::size_t>(channel.variants[static_cast<std::size_t>(variant)].candidate)];
}

inline const std::vector<int>& columns_of(const ChannelFacts& channel, int variant) { return channel.variants[static_cast<std::size_t>(variant)].columns; }

/// RMS over the records of what the declared instruments may leave, share of the channel's scale.
double allowed_rms(const ResidualChannel& channel);

/// A drive whose force is late behind its command by about as much in every record; 0: none is seen to be.
struct LateDrive {
  double lag_s = 0.0, u_s = 0.0;              ///< median over the records, half their quartiles' distance
  double before_N = 0.0, after_N = 0.0;       ///< RMS of the force against the command's line, without and with the lag
  int records = 0;
};

struct Workspace {
  CampaignInput input;
  std::vector<RecordHealth> health;  ///< per record; the parts of one recording share that of its samples
  std::vector<Edges> edges;  ///< per record; of the parts of one recording the first has them all
  std::vector<HealthClaim> raw_claims;  ///< what the samples show before any fit
  HealthScales scales;
  std::vector<std::unique_ptr<EffectKind>> user_kinds;  ///< effects of the user's own, beside the registry
  BaseLaw law;
  bool zero_wanders = true;         ///< EngineOptions
  bool decays_otherwise = false;    ///< the maxima decay, and no law is more likely than `law`, which is static where it leaves more
  bool tells_swing = true;          ///< the records part the gain of the cycles from that of the rest (base_fit.h)
  double gain_V_per_N = 2.0;        ///< slope of the static law at the current fit
  std::vector<RecordShift> shifts;  ///< per record
  std::vector<double> noise_V;      ///< row noise of U at given F_ref, errors in variables included
  std::vector<double> white_V;      ///< its white part alone
  std::vector<double> smoothed_V;   ///< what smoothing leaves of the noise of F
  ResidualChannel output, rig, command;
  bool has_command = false;
  LateDrive late_drive;
  bool has_rig = false;
  std::vector<double> rig_slope_N;  ///< per record: newtons a unit of 1 - cos th; 0 without an angle
  RigShows rig_shows = RigShows::nothing;  ///< of a drift of the reference
  JudgedBy judges = JudgedBy::heldout;
};

/// A finding about an effect, of errors in `unit`: nothing is said of it yet.
Finding finding_about(const EffectKind& kind, const std::string& unit, ShownIn shown_in = ShownIn::output);
inline Finding finding_about(const EffectKind& kind, const ChannelFacts& channel) { return finding_about(kind, channel.unit, channel.shown_in); }

/// An answer about the campaign in which nothing is said yet.
Diagnosis answer_about(const Workspace& workspace, const std::string& model_name);
/// An effect by its name: the user's own, else that of the registry; null where neither has it.
const EffectKind* kind_of(const Workspace& workspace, const std::string& name);

}  // namespace forcegate::diagnose
