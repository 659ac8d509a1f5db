#pragma once
// What a family of effects asks the records: one predictor for each of its variants, of the gain or of the zero of each record.

#include <vector>

#include "hil/diagnose/between/between_records.h"

namespace forcegate::diagnose {

/// What one variant moves, and what explains it.
struct Asked {
  int variant = 0;
  RecordPredictor predictor;
  double log_weight = 0.0;       ///< ln of its prior, over the mean of its rivals'
  std::vector<int> places = {};  ///< of several steps at unknown places: the first record of every mounting but the first, counted from one
};

struct FamilyQuestion {
  std::vector<Asked> gain, zero;
  bool seeks_places = false;  ///< of steps that nobody wrote down: a course over time is a rival

  const std::vector<Asked>& part(bool of_gain) const { return of_gain ? gain : zero; }
};

FamilyQuestion ask(const ResidualChannel& channel, const RecordLevels& levels, const EffectKind& kind);

std::vector<RecordPredictor> predictors_of(const std::vector<Asked>& asked);

/// Scores of one part, in its order, without the weights.
std::vector<RecordScore> scores_of(const RecordLevels& levels, const FamilyQuestion& question, bool of_gain);

}  // namespace forcegate::diagnose
