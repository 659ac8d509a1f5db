#pragma once
// Counts over the matches of a league; pure arithmetic.

#include <array>
#include <map>
#include <string>
#include <vector>

#include "hil/app/league.h"

namespace forcegate {

struct Count {
  std::size_t k = 0, n = 0;
  void add(bool hit) { k += hit, ++n; }
};

/// Matches with one effect of the catalogue, of one strength.
struct TierTally {
  Count named, top2, top3, look_alike, named_excited, side, false_claims;
  std::vector<double> removed;
};

struct CalibrationBin {
  double low = 0.0, high = 1.0;
  double stated = 0.0;  ///< sum of the stated probabilities
  Count truth;
};

struct LeagueTally {
  std::array<TierTally, 3> tiers;
  Count control_false, foreign_honest, foreign_claimed, foreign_coordinate, pairs, pairs_one, sensor_blamed,
      no_answer;
  std::vector<CalibrationBin> calibration;  ///< over every finding of every match
  std::map<std::string, std::array<Count, 3>> by_effect;
  std::map<std::string, std::map<std::string, int>> confusions;  ///< hidden -> first answer instead
  std::vector<double> engine_s, generation_s;
};

LeagueTally tally(const LeagueResult& result);

/// The match did not go as the truth demands: not named, not both of a pair, not honest, or not silent.
bool is_miss(const LeagueMatch& match);

}  // namespace forcegate
