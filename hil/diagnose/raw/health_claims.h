#pragma once
// What the detectors of the samples claim over all records of a campaign.

#include <cstddef>
#include <string>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

/// A line far above its neighbours and of a size that matters.
bool shows_hum(const RecordHealth& health, const HealthScales& scales);

/// How many records show the line of a mains, and how many can: of those whose rate folds it onto the slow nothing can be told.
struct RecordsOfHum {
  std::size_t show = 0, can_show = 0;
};
RecordsOfHum records_of_hum(const std::vector<RecordHealth>& health, const HealthScales& scales, double mains_Hz);

/// Two records show it, or the only one that can, and half of those that can.
bool is_hum(const RecordsOfHum& records);

/// A detector's claim over the whole campaign.
struct HealthClaim {
  std::string effect;
  double probability = 0.0;
  std::string evidence;
  std::string parameter, unit;
  double value = 0.0, u = 0.0;
  std::vector<SampleWindow> samples{};  ///< hil/diagnose/raw/sample_windows.h
};
std::vector<HealthClaim> health_claims(const std::vector<RecordHealth>& health, const HealthScales& scales,
                                       const BenchFacts& bench);

/// Which samples no fit uses although no claim speaks of them; empty: none.
std::string note_of_left_out(const std::vector<RecordHealth>& health, const std::vector<HealthClaim>& claims);

}  // namespace forcegate::diagnose
