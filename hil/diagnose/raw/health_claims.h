#pragma once
// What the detectors of the samples claim over all records of a campaign.

#include <string>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

/// A detector's claim over the whole campaign.
struct HealthClaim {
  std::string effect;
  double probability = 0.0;
  std::string evidence;
  std::string parameter, unit;
  double value = 0.0, u = 0.0;
  std::vector<SampleWindow> samples{};  ///< hil/diagnose/raw/sample_windows.h
};
std::vector<HealthClaim> health_claims(const std::vector<RecordHealth>& health, const HealthScales& scales, const BenchFacts& bench);

/// Which samples no fit uses although no claim speaks of them; empty: none.
std::string note_of_left_out(const std::vector<RecordHealth>& health, const std::vector<HealthClaim>& claims);

/// From which records hum was taken off although no claim speaks of it, and how much (amplitude); empty: from none.
std::string note_of_hum_taken_off(const std::vector<RecordHealth>& health, const HealthScales& scales, const std::vector<HealthClaim>& claims);

/// For whoever fits and does not diagnose: what the claims speak of is no part of the errors. Empty: there are none.
std::string note_of_claims(const std::vector<HealthClaim>& claims);

}  // namespace forcegate::diagnose
