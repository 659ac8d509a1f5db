#pragma once
// The answer to "which physical effect is missing?": a value that reporters render and that holds no logic.
// Errors are RMS over the held-out records, each record weighing the same. "Adapted" figures let the record's own
// repeatability (gain, offset, decay rate and depth, within the spread estimated from the campaign) follow the data;
// "plain" figures predict the record from the others alone.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "hil/diagnose/choose/refusal.h"

namespace forcegate {

enum class DiagnosisVerdict { none, known, unknown };
std::string to_string(DiagnosisVerdict verdict);

struct FoundParameter {
  std::string name;
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty, k = 1
  std::string unit;
};

/// Another effect whose signature on these records is nearly the same (|cos| of the signatures after what the base
/// law and the repeatability explain is projected off).
struct LookAlike {
  std::string effect;
  double cosine = 0.0;
  std::string separates;  ///< the stimulus that settles it
};

/// x-y data of one evidence picture; `before` and `after` are residuals of the model without and with the effect.
struct EvidenceSeries {
  std::string record;
  std::string title;                             ///< "residual against force, coloured by direction"
  std::string x_name, x_unit;                    ///< "force", "N"
  std::string y_unit;                            ///< "V"
  std::vector<double> x, before, after, colour;  ///< colour: sign of dF/dt, or empty
};

/// Samples that a claim about raw samples names, with those around them.
struct SampleWindow {
  std::string record;
  std::string quantity, unit;                ///< "output", "V"
  std::string beside_name;                   ///< what `beside` is: "as the force says"
  std::vector<double> t_s, recorded, beside;
  std::vector<double> named_t_s, named;      ///< where and what the named samples are; empty: all of them
};

/// Why a finding is less sure than what bears it out.
struct Reservation {
  double most = 1.0;  ///< probability that it leaves
  std::string why;
};

/// A finding at least this probable is a claim.
inline constexpr double kClaim = 0.5;
/// To which what may well be there is lowered: a suspicion. Whether something is claimed, Finding::claimed() says.
inline constexpr double kNoClaim = 0.49;
/// To which what something else explains as well or better is lowered.
inline constexpr double kWithdrawn = 0.2;
static_assert(kWithdrawn < kNoClaim && kNoClaim < kClaim);
/// "0.49" of 0.498: two digits, never rounded over the border of a claim.
std::string probability_text(double probability);

/// RMS of a model over that of the noise which its instruments may leave, up to which it describes the records: noise is declared no better.
inline constexpr double kToItsNoise = 1.5;
/// The same from which something is left that no instrument makes: one that is declared too good by twice stays below.
inline constexpr double kFarAboveNoise = 2.5;

/// What shows a finding: the output against the reference, the reference against the rig's own law, what the drive makes of its command, or a
/// detector in the samples themselves.
enum class ShownIn { output, rig, command, samples };
/// Form of a finding of a detector: no term of a model.
inline constexpr const char* kOfSamples = "raw";

/// Forms of a delay that was found together with the model's lag, or behind a bent curve: the output is to be set earlier, no term of a model is in
/// series with these.
inline constexpr const char* kBehindLag = "behind_lag";
inline constexpr const char* kBehindCurve = "behind_curve";

struct Finding {
  std::string effect;
  std::string side;          ///< sensor, rig, reference, instrument
  ShownIn shown_in = ShownIn::output;
  double probability = 0.0;  ///< a claim from kClaim on
  std::vector<FoundParameter> parameters;
  double error_before = 0.0, error_after = 0.0;  ///< held-out, adapted, in `unit`
  std::string unit = "V";
  std::vector<LookAlike> confounded_with;
  std::string evidence;     ///< one sentence a person understands
  bool in_model = false;    ///< the model has it already, as a guess that these records bear out: it is not missing
  std::string rival_of;     ///< the effect that it fits nearly as well as, and shares the probability with; else empty
  std::string form;         ///< which form of the effect was fitted
  double effect_rms = 0.0;  ///< RMS of what the effect adds, same unit
  int records_improved = 0, records_excited = 0;
  bool of_every_record = false;  ///< errors of all records, each predicted from the others: the held-out ones alone do not show it
  bool counts_parts = false;  ///< of records, where too few show it: these two count parts
  std::vector<EvidenceSeries> series;
  std::vector<SampleWindow> samples;  ///< of a claim about raw samples
  bool side_witnessed =
      true;  ///< false: no third channel could tell sensor from reference; said in `evidence`
  bool name_is_open = false;  ///< no claim, and yet there is something: at kNoClaim the verdict is no "none"
  std::vector<Reservation> reservations;  ///< in the order in which they were made
  bool between_records = false;  ///< it changes gain or zero from record to record: their levels are its evidence

  bool claimed() const { return probability >= kClaim; }
  bool of_output() const { return shown_in == ShownIn::output; }
  bool of_samples() const { return shown_in == ShownIn::samples; }
  /// Its errors are of the reference, in newtons.
  bool of_reference() const { return shown_in == ShownIn::rig || shown_in == ShownIn::command; }

  /// Lowers a probability above `most` to it, and says why in `reservations` and at the end of `evidence`. The only way to a lower one.
  /// True when it was above.
  bool limit(double most, const std::string& why);
  /// Says the same of one that its evidence left below a claim.
  void not_claimed(const std::string& why);
};

/// One row of the ranking: every effect of the library that the data can excite.
struct RankedEffect {
  std::string effect, side, form;
  double score = 0.0;   ///< log evidence over the base model, natural units, on effective samples
  double alone = 0.0;   ///< share of the explainable residual energy it takes away alone
  double unique = 0.0;  ///< share that only it takes away, given the other findings
  double probability = 0.0;
  double null_score = 0.0;  ///< largest score expected from this family on sign-flipped blocks (largest of the flips)
  double visible_from =
      0.0;           ///< share of the span (RMS) from which these records would show it; 0: not estimated
  std::string note;  ///< "not excited", "wrong sign", "needs temperature" ...
};

/// An effect that came up and was not taken.
struct RefusedEffect {
  std::string effect;
  diagnose::Refusal reason = diagnose::Refusal::none;
  double score = 0.0;  ///< log evidence beside what had been taken, natural units
};

/// Which records tell the error of a model.
enum class JudgedBy {
  heldout,   ///< those that the campaign marks as held out
  left_out,  ///< none is marked: each is left out in turn
  whole,     ///< one recording whose parts do not repeat each other: all rows, which it was fitted to as well
};
std::string to_string(JudgedBy by);
/// "held-out error", or what it is where nothing could be held out.
std::string error_name(JudgedBy by);

/// A record of which the model leaves far more than its instruments may.
struct RecordFarAbove {
  std::string record;
  double times = 0.0;  ///< RMS of what is left over that of what they may leave
};

struct ErrorPair {
  double before = 0.0, after = 0.0;
  std::string unit;
  bool levels = false;  ///< as Diagnosis::levels
};

struct RecordError {
  std::string record, kind;
  bool heldout = false;
  double before = 0.0, after = 0.0;  ///< adapted
  double plain_before = 0.0, plain_after = 0.0;
  double floor = 0.0;        ///< noise of this record's residual
  double explainable = 0.0;  ///< share of the squared residual above the floor
};

/// Residual against one coordinate: cell means with block standard errors; empty cells have n = 0.
struct MapCell {
  double x = 0.0, mean = 0.0, standard_error = 0.0;
  int n = 0;  ///< rows
  int blocks = 0;
};
/// Unit of a coordinate that is log10(1 s + time).
inline constexpr const char* kLogOfTime = "log10 s";
inline double seconds_of_log(double log_of_time) { return std::pow(10.0, log_of_time) - 1.0; }

struct ResidualMap {
  std::string coordinate;  ///< "force", "rate", "force while unloading", "time since change" ...
  std::string group;       ///< time, force, rate, frequency, history, temperature, angle
  std::string unit;
  double share = 0.0;  ///< cross-fitted share of residual variance, may be < 0
  std::vector<MapCell> cells;
  std::string sentence;  ///< "+12 mV while unloading above 3 N"
};

struct ExperimentSegment {
  std::string name;      ///< "triangle at three rates"
  std::string kind;      ///< of the record, as a campaign's description calls it
  std::string stimulus;  ///< name in stimuli/; "replay" of profile_name() where no other one is this force
  std::map<std::string, double> numbers;               ///< its parameters
  std::map<std::string, std::vector<double>> lists{};  ///< those of them that are lists
  double minutes = 0.0;
  std::string separates;  ///< "hysteresis / lag"
  double cosine_before = 0.0, cosine_after = 0.0;
  double odds_before = 1.0, odds_after = 1.0;  ///< expected odds of the better rival; the first segment starts from what is known
  bool odds_stated = false;                    ///< known from the findings' probabilities; else from the evidence
  std::vector<double> t_s, force_N;            ///< the force that was simulated: what a rig has to play
  double f_min_Hz = 0.0;                       ///< lowest frequency of its cycles; 0: not cyclic
  bool heats = false;                          ///< the temperature must rise meanwhile
  double rise_degC = 0.0;                      ///< by so much
  double low_N() const { return force_N.empty() ? 0.0 : *std::ranges::min_element(force_N); }
  double high_N() const { return force_N.empty() ? 0.0 : *std::ranges::max_element(force_N); }
};
/// File of its force below the folder that `forcegate next -o` writes: "profiles/2_fast_edges.csv"; `number` counts from 1.
std::string profile_name(const ExperimentSegment& segment, std::size_t number);
/// "cycles=5 high_N=3.9 ...": what its stimulus takes.
std::string parameters_text(const ExperimentSegment& segment, std::size_t number, const std::string& equals = "=", const std::string& between = " ");

struct NextExperiment {
  std::vector<ExperimentSegment> segments;
  double minutes = 0.0;
  std::string sentence;
};

struct Repeatability {  ///< spread between records, estimated from the campaign (a standard deviation, by n - 1)
  double gain = 0.0, offset_V = 0.0;
  double log_b = 0.0, log_q = 0.0;  ///< missing where fewer than two records decay
  double wander_V = 0.0;  ///< of the zero within a record, RMS
};

/// The model with the effects up to this one; the first step, without a name, is the base law with bad samples and mains set aside.
struct ModelStep {
  std::string effect;
  double error = 0.0;  ///< held out, as error_after
};

struct Diagnosis {
  std::string campaign;
  std::string model;
  bool single = false;  ///< one recording: its records are parts of it
  DiagnosisVerdict verdict = DiagnosisVerdict::none;
  bool residual_unknown = false;
  std::vector<Finding> findings;                              ///< claims first, then weaker ones
  std::vector<std::string> depends_on;                        ///< at most three groups
  std::vector<std::string> follows;                           ///< what no effect covers and explains it best: "the largest force so far"
  double error_before = 0.0, error_after = 0.0, floor = 0.0;  ///< adapted, V
  bool levels = false;  ///< a claim acts between records: adapted then means the decay alone, gain and zero are those of all records
  bool no_input = false;  ///< laws of time alone: nothing is adapted
  double plain_before = 0.0, plain_after = 0.0;
  JudgedBy judged_by = JudgedBy::heldout;
  std::vector<ModelStep> steps;  ///< of a diagnosis, in the order in which effects were taken in
  std::string unit = "V";
  std::map<std::string, ErrorPair> errors;  ///< "F" when the rig's law is at fault, "U_plain" always
  std::vector<RecordFarAbove> far_above;    ///< the farthest first
  std::vector<RecordError> records;
  std::vector<ResidualMap> maps;  ///< residual of the base model, largest share first
  std::vector<ResidualMap> maps_after;
  std::vector<ResidualMap> rig_maps;  ///< F_ref less the rig's law, N: where it depends on what no claim explains
  std::vector<RankedEffect> ranking;
  std::vector<EvidenceSeries> overlays;  ///< measured and modelled U of every record, thinned
  Repeatability repeatability;
  std::vector<std::vector<std::string>>
      not_separable;            ///< effects that explain the same residual of these records
  double expected_false = 0.0;  ///< expected number of false effects at the threshold used, from sign flips
  NextExperiment next_experiment;
  std::vector<RefusedEffect> refused;
  std::vector<std::string> notes;
  double force_range_N = 0.0, voltage_range_V = 0.0;
};

/// Whether what is left is what the instruments leave, so that no further effect can be hidden in it.
inline bool is_noise(double error, double floor) { return floor > 0.0 && error <= kToItsNoise * floor; }

/// Records that are each described by a gain and zero of their own, and not by one for all.
inline bool differs_between_records(const Diagnosis& d) {
  constexpr double kFar = 3.0;
  return !d.single && d.plain_after > kFar * d.error_after && is_noise(d.error_after, d.floor);
}

/// Whether the records that judge are described plainly worse with what is claimed than without.
inline bool is_described_worse(const Diagnosis& d) {
  constexpr double kAboutTheSame = 1.02;
  return d.error_after > kAboutTheSame * d.error_before;
}

/// Effects beside a "none" that take far more than the noise away and are not claimed all the same.
std::vector<const Finding*> suspicions_beside_none(const Diagnosis& diagnosis);
/// What stands beside a "none" and is no claim, for people: suspicions, records far above their noise. Empty: nothing, or no "none".
std::string beside_none(const Diagnosis& diagnosis);

/// Of an unknown verdict without rivals that cannot be told apart: the finding that would explain what is there, and is not claimed since
/// others would as well (Finding::name_is_open); null: there is none.
const Finding* open_name(const Diagnosis& diagnosis);

/// What was refused with evidence and does not stand among the findings: for people, who have read those.
inline std::vector<RefusedEffect> refused_beside_findings(const Diagnosis& d) {
  std::vector<RefusedEffect> out;
  for (const RefusedEffect& r : d.refused)
    if (diagnose::traits_of(r.reason).suspicion && std::none_of(d.findings.begin(), d.findings.end(), [&](const Finding& f) { return f.effect == r.effect; }))
      out.push_back(r);
  return out;
}

/// The JSON of docs/campaign.md, schema 1.
std::string to_json(const Diagnosis& diagnosis);

}  // namespace forcegate
