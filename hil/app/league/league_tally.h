#pragma once
// Counts over the matches of a league; pure arithmetic.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "hil/app/league/league.h"

namespace forcegate {

/// d' from which an effect between records is plain to an observer who knows its course (rigs/emulated/hidden/detectability.h).
inline constexpr double kPlainDetectability = 4.0;

struct Count {
  std::size_t k = 0, n = 0;
  void add(bool hit) { k += hit, ++n; }
};

/// Matches with one effect of the catalogue, of one strength.
struct TierTally {
  Count named, top2, top3, look_alike, named_excited, side, false_claims;
  Count within;         ///< of these named first: effects within records
  Count between;        ///< effects that move gain and zero from record to record
  Count between_plain;  ///< of those with kPlainDetectability or more and a recorded cause
  std::vector<double> removed;        ///< share of the reducible error, 0 of a miss, where there is any
  std::vector<double> removed_named;  ///< the same of those named first
};

struct CalibrationBin {
  double low = 0.0, high = 1.0;
  double stated = 0.0;  ///< sum of the stated probabilities
  Count truth;
};

/// One effect of the catalogue (or one foreign effect) over its campaigns.
struct EffectTally {
  std::array<Count, 3> named;           ///< weak, medium, strong; foreign: called unknown
  std::vector<double> rms_pct;          ///< of its channel's span, as published in the truth
  std::vector<double> rms_voltage_pct;  ///< plain RMS in U, % of its span
  Count excited, naive;
  std::map<std::string, int> stages;   ///< where it was lost
  std::map<std::string, int> instead;  ///< first answer instead
};

struct LeagueTally {
  std::array<TierTally, 3> tiers;
  Count control_false;   ///< verdict other than none, or a claim
  Count control_claims;  ///< a claim
  Count foreign_honest, foreign_claimed, foreign_coordinate, pairs, pairs_one, sensor_blamed, no_answer;
  std::array<Count, 3> naive_named;  ///< largest residual correlation, one hidden effect
  Count naive_control_false, naive_foreign_honest;
  std::vector<CalibrationBin> calibration;  ///< over every finding of every match
  double calibration_error = 0.0;           ///< largest |stated - true| over bins of at least 20 findings
  std::map<std::string, EffectTally> by_effect;
  std::map<std::string, int> control_answers;  ///< first answer on clean campaigns that were not left alone
  std::map<std::string, int> pair_stages;
  std::vector<double> engine_s, generation_s;
};

LeagueTally tally(const LeagueResult& result);

/// The match did not go as the truth demands: not named, not both of a pair, not honest, or not silent.
bool is_miss(const LeagueMatch& match);

}  // namespace forcegate
