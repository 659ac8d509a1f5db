#pragma once
// A frequency sweep of one sensor at one force (Paredes-Madrid 2010, Figs. 6 to 8) and its Bode fit.

#include "hil/characterize/capacitance/weight_study.h"

namespace forcegate::characterize {

/// Frequencies of the sweep, Hz: about logarithmic, each a whole number of periods in the plan's samples.
std::vector<double> sweep_frequencies_Hz(const WeightPlan& plan, double rate_Hz);

/// Errors: of the bench. A sweep that cannot be fitted has fitted = false.
Result<SweepResult> play_sweep(WeightBench& bench, std::size_t sensor, double force_N,
                               const WeightPlan& plan);

}  // namespace forcegate::characterize
