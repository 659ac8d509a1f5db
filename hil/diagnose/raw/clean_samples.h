#pragma once
// The samples of one record before any rows are made of them: raw health, hum taken off, the reference smoothed within its noise.

#include "hil/diagnose/raw/raw_health.h"
#include "hil/diagnose/raw/sample_windows.h"

namespace forcegate::diagnose {

struct CleanedSamples {
  RecordHealth health;
  std::vector<CutOut> cuts;
};

/// Changes the record's channels U and F_ref: where the bench declares a low-pass of the reference, U is behind it too afterwards.
/// `draw`: cuts for pictures too.
CleanedSamples clean_samples(Record& record, const HealthScales& scales, const BenchFacts& bench, bool draw);

/// Tells what it does to all records because the bench was declared so.
void note_cleaning(const BenchFacts& bench, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
