#pragma once
// S0: what the samples themselves say at full rate, before any fit. Detectors with their own evidence; what an
// instrument is declared to do (resolution, noise, range, bits) is never a finding.

#include <cstdint>
#include <string>
#include <vector>

#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/raw/health_scales.h"
#include "hil/diagnose/raw/reference_scatter.h"
#include "hil/diagnose/raw/short_spikes.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

/// Why no fit may use a sample.
enum class BadSample : std::uint8_t {
  none,
  missing,
  zero,      ///< at the low end where the force says otherwise
  outlier,
  bit,       ///< off by the weight of one bit of the converter
  held,      ///< at its last value, or a block that was sent before
  rail,
  censored,  ///< at a declared end of the range, or next to a rail: no fault
};

/// Samples of one value while the force moves on.
struct HeldRun {
  double value_V = 0.0, before_V = 0.0;  ///< before_V: the sample that came before
  std::size_t samples = 0;
  double error_V = 0.0;  ///< half of what the force moved meanwhile
};

struct RecordHealth {
  std::string record;
  std::vector<std::uint8_t> bad;  ///< BadSample of every sample
  std::size_t samples = 0, outliers = 0, held = 0, zeros = 0, at_rail = 0, gaps = 0;
  std::size_t zero_runs = 0;                  ///< at the low end where the force says otherwise
  std::size_t missing = 0, missing_runs = 0;  ///< of the output alone: the reference went on
  std::size_t reference_missing = 0;          ///< of the reference alone
  double missing_variance = 0.0;              ///< of the difference of the two if runs come independently: sum of their squared lengths
  std::size_t lone_zeros = 0;                 ///< single samples at the low end: a lost sample, or a spike that was cut off there
  std::size_t outlier_parts = 0;              ///< eighths of the record in which single samples stand off
  double outlier_square_V2 = 0.0;             ///< sum over the outliers of what they stand off by, squared
  std::vector<Jump> lone_jumps;               ///< of the outliers that are single samples
  double near_V = 0.0;                        ///< levels that are nearer than that are one
  std::size_t bit_errors = 0;                 ///< spikes that all have the size of one bit of the converter
  double bit_V = 0.0;                         ///< that size
  double noise_U_V = 0.0, noise_F_N = 0.0;    ///< white noise per sample; of the force less what its movement and a jittering clock make of it
  double smoothed_F_N = 0.0;                  ///< noise of the reference that smoothing leaves; 0 where nothing was smoothed
  double beside_line_N = 0.0;                 ///< RMS of the force beside a straight line in the output
  ReferenceScatter scatter_F;                 ///< of the reference beside the output, coloured noise included
  double lsb_U_V = 0.0, lsb_F_N = 0.0;        ///< step of the values, 0 when none is visible
  double rail_V = 0.0;                        ///< voltage of the flat tops, when there are some
  std::size_t silent_runs = 0;                ///< of one code where noise goes over the codes (silent_runs.h)
  std::size_t silent = 0;                     ///< samples of these, not in `held`
  std::size_t repeated_blocks = 0;            ///< of the output, sent a second time (repeated_blocks.h)
  std::size_t repeated = 0;                   ///< samples of these, not in `held`
  std::vector<HeldRun> runs;                  ///< those that `held` and `at_rail` count
  double top_V = 0.0;                         ///< largest output
  double hum_V = 0.0, hum_Hz = 0.0, hum_ratio = 0.0;  ///< strongest mains line, as sampled, and its power over its neighbours
  double mains_Hz = 0.0, rate_Hz = 0.0;               ///< one of kMains_Hz, and the rate of sampling that folds it
  double bad_mean_square_V2 = 0.0;                    ///< what the bad samples, and hum that was taken off, add to the mean squared error
};

/// Force and output on one clock (hil/trace/common_clock.h).
RecordHealth check_raw_health(const Record& record, const HealthScales& campaign, const BenchFacts& bench);

}  // namespace forcegate::diagnose
