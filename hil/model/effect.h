#pragma once
// A physical effect that can be missing from a model. One file each in hil/model/effects/ registers an EffectKind.
//
// Every form of an effect adds to the sensor's output (channel output) or to the reference force (channel rig)
//
//   dU = g * sum_j c_j * s_j(history of F, t, theta, T ...; shape)        s_j in newtons of equivalent force,
//
// with c_j the strengths (neutral value 0) and `shape` constants such as a time constant or a play radius. s_j is
// the tangent of the output at zero strength; the same columns serve screening, fitting, simulation and export, so
// there is one state machine per effect.

#include <Eigen/Core>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/model/record_input.h"

namespace forcegate {

struct ParameterSpec {
  std::string name;  ///< with unit suffix where it has a unit
  std::string unit;  ///< "1" for pure numbers
  double minimum = 0.0, maximum = 0.0;
  double neutral = 0.0;  ///< strength: 0. Shape: a typical value.
  std::string doc;
  bool choice = false;  ///< of two values, 0 or else: belongs to the model, and is nothing that is measured
};

enum class EffectChannel {
  output,  ///< changes U at given F_ref
  rig,     ///< changes F_ref at given angle or command
  raw      ///< seen in the samples themselves; no columns, a detector of hil/diagnose finds it
};

/// Which sign of a strength is physical. `either`: both.
enum class StrengthSign { either, positive, negative };

using ColumnsRef = Eigen::Ref<Eigen::MatrixXd>;

/// What was recorded or written down of the cause of an effect between records, one number for each record: what its evidence is drawn against.
struct RecordedCause {
  std::string name, unit;
  std::function<double(const RecordInput&)> of_record;  ///< empty: nobody recorded it
  double plain = 0.0;  ///< in `unit`: between records that differ by so much and more, an effect of it is likely
  /// The same at every row, behind the form's own lag; empty: it is one number for each record
  std::function<std::vector<double>(const CampaignInput&, const RecordInput&, std::span<const double> shape)> of_rows = {};
};

/// What the rig's own law shows of the reference's zero.
enum class RigShows {
  nothing,
  zero_of_records,       ///< one law for all records: where each record's zero stands, and its course
  course_within_records, ///< a line of each record's own, which takes its mean away: how the zero moves within it
};

struct EffectForm {
  std::string name;  ///< "play_bank", "bouc_wen"
  std::vector<ParameterSpec> shape;
  std::vector<ParameterSpec> strength;  ///< one per column
  std::vector<double> memory_s = {};    ///< time constant of each column, where they differ in it alone
  StrengthSign sign = StrengthSign::either;
  /// Shapes to screen, given the campaign's scales. One empty shape when the form has none.
  std::function<std::vector<std::vector<double>>(const CampaignInput&)> grid;
  /// Fills rows x strength.size() columns. Pure; rows that it cannot know are 0.
  std::function<void(const CampaignInput&, const RecordInput&, std::span<const double> shape, ColumnsRef)>
      columns;
  /// Sums of strengths outside are another effect in disguise: a pole of twice the force with half the time constant is a delay.
  double least = -1e300, most = 1e300;
  bool refine = true;    ///< shapes are continuous: the screen may search between the points of the grid
  bool singles = false;  ///< screen each column alone too (banks)
  bool bank = false;     ///< the family's most flexible form, used to soak up a wrong form's remains
  bool only_further = false;  ///< beside another form of the family, never in its place
  bool whole = false;    ///< what other forms of the family move one by one: taken where both are asked for, and not asked itself
  bool outlasts = false; ///< its state runs on from record to record and moves their levels, which are asked first (hil/diagnose/between/outlasting.h)
  bool one_law = false;  ///< all of the effect is one such law: not taken beside another form of the family
  bool last = false;     ///< so flexible that it is asked only where nothing else is found, and nothing is asked beside it
  RigShows after_rig = RigShows::nothing;  ///< of the output, where the rig has shown so much of the reference
  bool groups = false;   ///< a column belongs to one group of records each, the first group has none
  RecordedCause cause = {};
  std::string beside = {};  ///< an effect that the model must have: the form is how this one and that one act together

  /// For the rows of the records.
  bool competes() const { return !only_further && !whole && !outlasts; }
};

/// By how much of a second an effect of time makes the output late.
enum class TimeShift {
  none,          ///< it is no shift
  first_shape,   ///< strength times the first constant of its shape
  percent_lead,  ///< strength in hundredths of a second, ahead
};

/// What the judge must know of a family beside its columns.
struct EffectTraits {
  bool between_records = false;  ///< changes gain or zero from record to record, where their repeatability absorbs it
  bool needs_records = false;    ///< and nothing else: one recording cannot show it
  bool timing = false;           ///< of time alone: what one such family explains, the others nearly explain too
  TimeShift shift = TimeShift::none;  ///< of such a family: what two clocks are forgiven
  bool late = false;             ///< a plain shift or tail: beside a lead that is carried along, it only mends the lead
  bool known_form = false;       ///< one course, known but for its strength, which is then the same in all records that show it
  bool any_course = false;       ///< any curve, loop or tail of its kind: the right one leaves little
  bool of_cycling = false;       ///< cycling itself is its cause: what records have in common that are cycled is no evidence of it
  bool at_voltages = false;      ///< stands at voltages of its own, whatever the sensor's gain
  bool in_samples = false;       ///< a detector finds it in the samples too, beside its columns
};

/// What a campaign must have beside F and U.
enum class Need {
  theta,
  drive,
  command,
  witness,  ///< angle or command: what the rig did
  generic,  ///< no force sensor's recording
};

struct EffectKind {
  std::string name;  ///< "hysteresis", as CAMPAIGN names it
  std::string side;  ///< sensor, rig, reference, instrument
  EffectChannel channel = EffectChannel::output;
  std::string summary;   ///< one sentence a person understands
  std::string equation;  ///< plain text
  std::string source;
  std::vector<std::string> look_alikes;
  std::string separates;  ///< stimulus that settles it
  std::vector<Need> needs;
  EffectTraits traits = {};
  std::vector<EffectForm> forms;
};

using EffectRegistry = Registry<EffectKind>;

/// Whether the levels of the records, gain and zero, are evidence of it: EffectTraits::between_records, or a form that outlasts a record.
bool shows_in_levels(const EffectKind& kind);
/// EffectTraits::between_records by name; false where the registry has none of it.
bool is_between_records(const std::string& effect);
/// EffectTraits::timing, likewise.
bool is_timing(const std::string& effect);

/// Effects that the library knows to be mistaken for each other.
bool look_alike(const EffectKind& a, const EffectKind& b);

/// Whether a detector of the raw samples finds the effect.
inline bool is_detected(const EffectKind& kind) { return kind.channel == EffectChannel::raw || kind.traits.in_samples; }

/// True when the campaign has the channels that the effect needs.
bool is_available(const EffectKind& kind, const CampaignInput& campaign);

const EffectForm* find_form(const EffectKind& kind, std::string_view form_name);

/// A bank beside laws of the same family, with strengths of either sign: it takes up what a wrong form leaves, and is no law itself.
inline bool soaks_up(const EffectKind& kind, const EffectForm& form) { return form.bank && kind.forms.size() > 1 && form.sign == StrengthSign::either; }

}  // namespace forcegate
