#pragma once
// `forcegate next`: what to measure next so that the rivals part.

#include "hil/app/diagnose.h"

namespace forcegate {

/// "12.3", "over 1000": a simulation promises more than a bench keeps, and beyond a thousand to one nothing more is learnt.
std::string odds_text(double odds);
std::string next_text(const NextExperiment& next);
std::string next_json(const NextExperiment& next);

}  // namespace forcegate
