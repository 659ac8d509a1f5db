#pragma once
// S5: forward choice of effects with a backward check, on log evidence and on records that were left out.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hil/diagnose/base/left_out.h"
#include "hil/diagnose/choose/refusal.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

struct ChosenEffect {
  const EffectKind* kind = nullptr;
  int variant = 0;
  std::vector<int> columns;       ///< the variant's own
  std::vector<int> further;       ///< variants of the same family that stand beside it in the model
  double gain = 0.0;              ///< log evidence when it entered
  double fall = 0.0;              ///< share of the excess mean square that it removed when it entered
  double excess = 0.0;            ///< mean square above the noise before it entered
  double effect_rms = 0.0;        ///< share of the span
  double unique = 0.0;            ///< log evidence that the final model loses without it
  double share_of_family = 0.0;   ///< softmax over the families that competed, at the working temperature
  double strength_scatter = 0.0;  ///< between records, relative to the strength
  bool between = false;           ///< it acts from record to record
  RecordEvidence records;         ///< of an effect between records
  double chance = 1.0;            ///< that its records in another order would show as much
  Refusal not_by_records = Refusal::none;  ///< why one number for each record does not bear it
  CrossFit left_out;              ///< against the model before it entered
  double error_before = 0.0, error_after = 0.0;  ///< RMS of records that were left out, channel's unit; plain where it acts between them
  bool of_every_record = false;   ///< these are of all records, each predicted from the others: the held-out ones alone do not show it
  bool describes_whole = false;   ///< hil/diagnose/base/whole_recording.h
  bool completes_whole = false;   ///< all that was chosen describes the whole, and without its family it does not
  bool borne_out = true;          ///< that error falls, or it describes the whole
  bool stands_out = false;        ///< a later one that leaves much, but is far above what else would explain it
  bool seen_in_place = false;     ///< what it does to the output shows right where it acts, whatever law is fitted (in_place.h)
  std::vector<std::pair<std::string, double>> rivals;  ///< family, share
  MixedFit fit;                                        ///< of the model with everything up to this effect

  bool by_records() const { return between && not_by_records == Refusal::none; }
};

struct Selection {
  ScreenResult first;  ///< screen over the base model alone
  std::vector<ChosenEffect> chosen;
  MixedFit base,
      final;         ///< final: the chosen effects with all forms of their families, to judge what is left
  MixedFit claimed;  ///< the chosen variants alone: what a model gains that takes them in
  double excess_before = 0.0, excess_after = 0.0;  ///< mean squares above the noise
  std::vector<std::string> nuisance;               ///< what was carried along without being a finding
  std::vector<int> carried;                        ///< its columns and those of the model
  Eigen::VectorXd set_aside;                       ///< strengths of what was taken off the channel's output; empty: nothing (reference_latency.h)
  std::vector<RefusedEffect> refused;              ///< what came up and was not taken
};

struct SelectionRules {
  double first_gain = 14.0, later_gain = 20.0;
  std::map<std::string, double> form_gain;  ///< forms of what every bench does a little must reach more
  double between_gain =
      3.0;  ///< nats. Prior odds of a given effect of this kind are 1 : 16: even odds are left
  double recorded_cause_gain = 1.4;  ///< the same where its cause was recorded and differs plainly: prior odds of 1 : 4
  double between_fall = 0.5;  ///< share of the spread between records (a variance) that it must explain
  double between_course_fall =
      0.75;  ///< the same where it follows no record of its cause: sessions of a bench look alike
  double between_left_out = 0.7;  ///< mean square error that records which were left out may keep
  double between_chance = 0.02;   ///< largest share of orders of the records that may do as well

  double first_fall = 0.10, later_fall = 0.50;
  double first_total_fall = 0.06,
         later_total_fall = 0.35;  ///< where the declared noise allows the whole residual
  bool where_it_acts = false;  ///< the records that an effect touches count: a drive has another fault in every manner of moving
  bool typical_record = false;  ///< what the typical one of them shows counts, whatever a single one leaves
  double form_error = 0.25;  ///< of the RMS that the largest effect removed: a second one must remove more
  bool forms_are_rough =
      false;  ///< the recording is of another machine: forms within form_error of each other are one
  double sure_gain = 40.0,
         sure_total_fall = 0.02;      ///< a small share is enough where the evidence is overwhelming
  double smallest_rms = 2.5e-4;       ///< of the span: less is below what the declared instruments can tell
  bool one_zero = false;          ///< one recording, and its parts have no gain and zero of their own
  std::string expected;           ///< what every sensor of this law has and the model lacks: the curve of an FSR; "": nothing. Prior odds kExpectedOdds
  double row_step_s = 0.0;            ///< a shift by so much and more flattens no noise of the reference; 0: not known
  bool clock_slack = true;            ///< a few milliseconds between two instruments are nobody's fault
  int most = 3;
};

/// Of the effect that is expected against any other one that fits as well.
inline constexpr double kExpectedOdds = 10.0;

/// ln of the prior odds of the family against one that nobody expects.
double log_prior(const EffectKind& kind, const SelectionRules& rules);

/// Score from which an effect is considered at all.
double threshold_of(const std::string& effect, const SelectionRules& rules);

/// Columns that are in before anything is chosen: of the base, and of the families of its effects, which only soak up what their forms leave.
struct Given {
  std::vector<int> base, soaking;
};

Selection select_effects(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                         const SelectionRules& rules, unsigned threads);

/// Takes the chosen effects that `goes` names out again and fits the rest anew.
void leave_out(const ResidualChannel& channel, const std::function<bool(const ChosenEffect&)>& goes, Selection& selection);

/// A family's best variant as a choice over the base that it was scored against, with the tests that an objection reads.
ChosenEffect as_chosen(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                       const SelectionRules& rules);

/// Cosine between what two sets of columns add, after the base law and the repeatability are projected off.
double signature_cosine(const ResidualChannel& channel, const MixedFit& base, const MixedFit& a,
                        const std::vector<int>& columns_a, const MixedFit& b,
                        const std::vector<int>& columns_b);

/// All columns that an effect has in the model of the claims, its further forms included.
std::vector<int> columns_of(const ResidualChannel& channel, const ChosenEffect& effect);

/// All that stands beside one of the chosen effects in the model.
std::vector<int> columns_beside(const ResidualChannel& channel, const std::vector<int>& carried, const std::vector<ChosenEffect>& chosen, const ChosenEffect& one);

/// Appends the columns that are not there yet.
void add_columns(std::vector<int>& to, const std::vector<int>& columns);

/// All columns of the screening grid of a family: what a form that is not quite right leaves behind must not be named.
std::vector<int> family_columns(const ResidualChannel& channel, const EffectKind& kind);

/// Columns of the family's most flexible form.
std::vector<int> bank_columns(const ResidualChannel& channel, const EffectKind& kind);

}  // namespace forcegate::diagnose
