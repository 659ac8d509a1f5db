#pragma once
// What a person looks at who doubts a claim about raw samples: some of the samples it names, among their neighbours.

#include "hil/diagnose/raw/health_claims.h"

namespace forcegate::diagnose {

/// One cut of a record, and the effects that it is evidence of.
struct CutOut {
  std::vector<std::string> effects;
  double weight = 0.0;  ///< how much of the fault the record shows
  SampleWindow window;
};

/// Of every kind of bad sample that the record has, where they are densest; `beside` is the line of U on F there.
std::vector<CutOut> cut_out_bad_samples(const Record& record, const RecordHealth& health, const HealthScales& scales);

/// Some periods of a line at `line_Hz`, as recorded (`before`) and without it.
CutOut cut_out_hum(const Record& without, const std::vector<double>& before_V, double line_Hz, double weight);

/// Where the reference moves least, as recorded (`before`) and smoothed; `weight`: its noise.
CutOut cut_out_reference_noise(const Record& smoothed, const std::vector<double>& before_N, double weight);

/// Gives every claim the cut of its effect that weighs most.
void add_sample_windows(const std::vector<CutOut>& cuts, std::vector<HealthClaim>& claims);

}  // namespace forcegate::diagnose
