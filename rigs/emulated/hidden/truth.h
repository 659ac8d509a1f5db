#pragma once
// What was hidden in a campaign, with its size in the recorded channels: the sheet that is sealed and
// revealed.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::hidden {

enum class Tier { none, weak, medium, strong };

std::string_view to_string(Tier tier);
Result<Tier> tier_of(std::string_view name);

struct TruthEffect {
  std::string name;
  std::string side;
  std::vector<std::string> also_side;
  std::string form;     ///< equation and constants in one sentence
  std::string measure;  ///< "voltage" or "force": the channel that rms_pct is of
  bool foreign = false;
  bool reducible = true;
  double strength = 0.0;                              ///< in the effect's own scale, 1 = typical
  double rms_pct = 0.0;                               ///< % of its channel's span, see campaign_maker.h
  double rms_voltage_pct = 0.0, rms_force_pct = 0.0;  ///< plain differences with and without the effect
  double heldout_rms = 0.0;                           ///< as rms_pct over the held-out records, in V or N
  bool excited = false;  ///< rms_pct above a fifth of the channel's noise and above 0.02 %; between records d' of at least 2 too
  bool between_records = false;         ///< moves gain and zero from record to record: `detectability` is told
  double detectability = 0.0;           ///< d' of an observer who knows its course, detectability.h
  bool cause_recorded = true;           ///< the columns and notes tell what moves it
  std::vector<double> record_rms_pct;   ///< plain, per record
  std::vector<std::string> depends_on;  ///< foreign: coordinates that a good answer may name
};

struct Truth {
  std::string campaign;
  std::uint64_t seed = 0;
  Tier tier = Tier::none;
  std::vector<TruthEffect> effects;  ///< empty: a clean campaign
  double voltage_span_V = 0.0, force_span_N = 0.0;
  double voltage_noise_pct = 0.0, force_noise_pct = 0.0;  ///< white noise and rounding of the channels
  double repeatability_pct = 0.0;  ///< RMS in U of the record-to-record scatter of gain and offset
  double minutes = 20.0;           ///< length of the long sines
  std::map<std::string, std::string> conditions;

  bool foreign() const { return !effects.empty() && effects.front().foreign; }
};

std::string to_json(const Truth& truth);
Result<Truth> truth_from_json(const std::string& text);

}  // namespace forcegate::hidden
