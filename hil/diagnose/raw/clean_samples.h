#pragma once
// The samples of one record before any rows are made of them: raw health, hum taken off, the reference smoothed within its noise.

#include "hil/diagnose/raw/raw_health.h"
#include "hil/diagnose/raw/sample_windows.h"

namespace forcegate::diagnose {

struct CleanedSamples {
  RecordHealth health;
  std::vector<CutOut> cuts;
};

/// Changes the record's channels U and F_ref. `draw`: cuts for pictures too.
CleanedSamples clean_samples(Record& record, const HealthScales& scales, const BenchFacts& bench, bool draw);

}  // namespace forcegate::diagnose
