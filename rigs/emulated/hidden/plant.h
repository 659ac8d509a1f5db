#pragma once
// One record of the hidden bench: controller and motor, eccentric wheel, spring, contact, film, decay,
// circuit, reference cell and the recorder that samples them. Effects change the signals in this order.

#include <memory>
#include <vector>

#include "rigs/emulated/hidden/conditions.h"
#include "rigs/emulated/hidden/effect.h"

namespace forcegate::hidden {

/// Columns of one record as the recorder writes them, and what it would have written without rounding.
struct RecordData {
  RecordPlan plan;
  RecordTruth truth;
  std::vector<double> stamp_s, force_ref_N, voltage_V, theta_rad, setpoint_N, temperature_C, humidity_pct, capacitance_F;
  std::vector<double> force_unrounded_N;  ///< reference reading before its resolution
};

using Effects = std::vector<std::unique_ptr<HiddenEffect>>;

/// Clock of a run. A preview uses coarse ones and leaves the slow columns out.
struct Clocking {
  double internal_Hz = 800.0;    ///< at least; the internal step divides the sampling period
  double sampling_Hz_max = 1e9;  ///< log no faster than this
  bool slow_columns = true;      ///< temperature, capacitance, angle, command
};

/// Runs the records in order. Effects are told begin_campaign first, so that the same object may be run
/// again. Noise depends on the record's seed alone: two runs that differ in an effect share every random
/// draw.
std::vector<RecordData> run_campaign(const Conditions& conditions, const Climate& climate,
                                     const std::vector<RecordPlan>& plans, const Effects& effects,
                                     const Clocking& clocking);

}  // namespace forcegate::hidden
