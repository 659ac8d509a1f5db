#pragma once
// What the detectors of the samples have counted over all records of a campaign.

#include <cstddef>
#include <string>
#include <vector>

#include "hil/diagnose/raw/raw_health.h"

namespace forcegate::diagnose {

/// Of the samples: fewer are left out, and no matter for a fit.
inline constexpr double kLeastShare = 1.5e-4;

/// Numbers of samples where the name does not say otherwise; of records: how many have some.
struct HealthTotals {
  std::size_t records = 0;
  double samples = 0.0;

  double outliers = 0.0, outlier_square_V2 = 0.0;  ///< sum of what these stand off by, squared
  std::size_t records_of_outliers = 0, records_of_two_outliers = 0;
  bool lone_are_spikes = false;  ///< spikes stand elsewhere too: single samples at the low end are counted among them

  double bit_errors = 0.0;
  std::vector<double> bit_V{};  ///< of the records that have bit errors

  double missing = 0.0, missing_variance = 0.0;  ///< of the output alone
  double reference_missing = 0.0;
  std::size_t missing_runs = 0, records_of_missing = 0;

  double held = 0.0;
  double silent = 0.0;  ///< not in `held`
  std::size_t silent_runs = 0, records_of_silent = 0;
  double repeated = 0.0;
  std::size_t repeated_blocks = 0, records_of_repeated = 0;
  double zeros = 0.0;
  double fallen = 0.0;  ///< zeros of the records that have runs of them, lone ones left out
  std::size_t zero_runs = 0, records_of_zeros = 0;
  std::size_t records_of_lost = 0;  ///< held or zero

  double at_rail = 0.0, rail_V = 0.0;  ///< rail_V: of the last record that has one

  double share(double some) const { return some / samples; }
  std::string percent(double some) const;  ///< "0.12 %" of the samples
  /// How many records must bear something out: one recording has no second.
  std::size_t several() const { return records < 2 ? records : 2; }
};
HealthTotals health_totals(const std::vector<RecordHealth>& health);

}  // namespace forcegate::diagnose
