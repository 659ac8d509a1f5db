#pragma once
// What the samples of one record are judged by.

#include "hil/diagnose/raw/force_and_output.h"
#include "hil/diagnose/raw/health_scales.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

struct RecordScales {
  double gain_V_per_N = 0.0, range_N = 0.0, U_range_V = 0.0;  ///< of the campaign
  double low_V = 0.0, high_V = 0.0;                           ///< ends of the converter; high_V is NaN where it is not declared
  double noise_F_N = 0.0, noise_U_V = 0.0;                    ///< white noise per sample
  double lsb_F_N = 0.0, lsb_U_V = 0.0;                        ///< step of the values, 0 when none is visible
  double quiet_V = 0.0;                                       ///< quiet_step_V()
  double near_V = 0.0;                                        ///< levels that are nearer than that are one
};

RecordScales record_scales(const ForceAndOutput& samples, const HealthScales& campaign, const BenchFacts& bench);

/// Steps that the lab declared, of the converter and the reference; 0: none. Counts have the step that they show.
double declared_step_V(const BenchFacts& bench, double U_range_V);
double declared_step_V(const CampaignInput& campaign);
double declared_step_N(const BenchFacts& bench);

/// What noise, of `noise_V` per sample, and steps of the values do between two samples, V.
double quiet_step_V(const ForceAndOutput& samples, double noise_V, double lsb_V, const HealthScales& campaign);

}  // namespace forcegate::diagnose
