#pragma once
// S8: how far a diagnosis has parted two effects already.

#include <optional>
#include <string>

#include "hil/diagnose/choose/probability.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

struct RivalOdds {
  double log_odds = 0.0;  ///< natural, of the first effect against the second, within +-20
  bool stated = false;    ///< those of the findings' probabilities; else those of the evidence in the ranking
};

/// The ratio of the probabilities where both effects stand among the findings, or the answer would contradict itself; elsewhere the
/// difference of their log evidence beside the base model. Nothing where both are claimed: such effects are no rivals.
std::optional<RivalOdds> rival_odds(const Diagnosis& diagnosis, const std::string& first, const std::string& second);

/// rival_odds of a later diagnosis by the measure of an earlier one: `stated` odds of probabilities, which are made of the evidence where the later one
/// states none; else those of the evidence.
std::optional<RivalOdds> rival_odds_as(bool stated, const Diagnosis& later, const std::string& first, const std::string& second);

/// Log evidence of the first over the second beside the base model, as the ranking has it; what is not ranked has none.
double evidence_between(const Diagnosis& diagnosis, const std::string& first, const std::string& second);

/// One of two findings stands there because it fits nearly as well as the other, or both do beside a third.
bool compete_for_one_place(const Diagnosis& diagnosis, const std::string& first, const std::string& second);

}  // namespace forcegate::diagnose
