#pragma once
// What we believe about a sensor: the base law, then effects in the order of their stage, each with its parameters,
// standard errors and the history of how it came in. A TOML file (docs/model.md).

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"
#include "hil/model/base_law.h"
#include "hil/model/effect.h"
#include "hil/model/model_frame.h"

namespace forcegate {

struct ModelParameter {
  std::string name, unit;
  double value = 0.0, se = 0.0;  ///< se 0: not estimated
  double minimum = 0.0, maximum = 0.0, neutral = 0.0;
  double written = kMissing;  ///< of a shape of the user's own: the value in the file, where a fit has moved it since; not kept in a file
};

struct ModelEffect {
  std::string effect, form;
  std::vector<ModelParameter> shape, strength;  ///< in the order of the form
};

/// A value and its standard error.
struct Estimate {
  double value = 0.0, se = 0.0;
};

/// One form of an effect of the library. `shape` and `strength` in the order of the form; strengths are kept within its bounds.
ModelEffect model_effect(const EffectKind& kind, const EffectForm& form, std::span<const double> shape,
                         std::span<const Estimate> strength);

/// An effect of the user's own: equations that muparser understands.
///   state.<name> = derivative, output = newtons of equivalent force added, in F, dF, t, T, th and the parameters.
struct UserEffect {
  std::string name;
  std::vector<ModelParameter> parameters;
  std::vector<std::pair<std::string, std::string>> states;  ///< name, derivative
  std::string output;
  std::vector<std::string> places{};  ///< "mine.toml:8:10" of the output, then of each derivative; empty: from no file
};

/// One step of the model's growth, errors on held-out records.
struct HistoryStep {
  std::string effect;  ///< "" for a refit
  std::string campaign;
  double error_before = 0.0, error_after = 0.0, floor = 0.0;
  double plain_before = 0.0, plain_after = 0.0;
  std::string unit = "V";
  bool accepted = true;  ///< false: the held-out error did not fall
  bool one_law = false;  ///< of an export: one law for all records, before is without effects; the errors are plain, no floor is known
};

struct Model {
  std::string name = "flexiforce";
  std::string sensor;
  std::string source;
  std::string output_unit = "V";  ///< of what the law gives: "S" for a resistance that is read as conductance, "counts", "1" for a ratio
  BaseLaw law;
  double se_gain = 0.0, se_offset = 0.0, se_b_scale = 0.0, se_q_scale = 0.0;
  ModelFrame frame;  ///< of the campaign that its effects were fitted on
  std::vector<ModelEffect> effects;
  std::vector<UserEffect> user_effects;
  std::vector<HistoryStep> history;

  std::vector<std::string> effect_names() const;
};

/// Errors name file, line and what is wrong (unknown effect: with a suggestion; parameter out of bounds).
Result<Model> read_model(const std::filesystem::path& path);
Result<Model> parse_model(std::string_view toml, const std::string& where);
std::string write_model(const Model& model);

/// Models that come with the program: "flexiforce", "fsr".
Result<Model> library_model(std::string_view name);
std::vector<std::string> library_model_names();
/// The library's model of a sensor as a lab writes it down: fsr for "FSR 402" or "Interlink ...", flexiforce for all others and for none.
std::string library_model_of(std::string_view sensor);

/// Output of every row of a record, volts: base law and all effects. `campaign`: in the frame of the model, for what its records did before.
/// The record's decay must be set (set_decay with model.law).
Result<std::vector<double>> model_output_V(const Model& model, const CampaignInFrame& campaign,
                                           const RecordInput& record);

/// Rows x 1: what a user effect adds in newtons at the given parameter values (explicit midpoint rule on the rows).
/// Errors (config): with muparser's message and position when an equation cannot be read; when it uses T or th and the record has none;
/// when a state or the output is not finite, with the time.
Result<std::vector<double>> user_effect_N(const UserEffect& effect, const RecordInput& record);

}  // namespace forcegate
