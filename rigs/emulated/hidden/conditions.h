#pragma once
// Conditions of a campaign: bench, instruments, repeatability and what the lab wrote down. Everything is
// drawn from the seed over wide ranges, from a careful laboratory to the spreads of Lebosse 2011, section
// III-D.

#include <cstdint>

#include "hil/base/rng.h"
#include "rigs/emulated/hidden/climate.h"
#include "rigs/emulated/hidden/decay.h"

namespace forcegate::hidden {

/// What effects ask of the bench so that they can act at all.
struct ConditionNeeds {
  bool theta = false, command = false, drive = false, remounting = false, climate = false,
       fast_reference = false;
};

struct Conditions {
  // logging
  double fast_rate_Hz = 400.0, slow_rate_Hz = 200.0;  ///< of short and of long records
  double jitter_share = 0.0;                          ///< sd of a sampling instant / period
  double clock_ppm = 0.0;
  bool stamps_true = false;  ///< recorder stamps true instants (else nominal ones)
  bool log_theta = true, log_command = false, log_temperature = false, log_humidity = false, log_capacitance = false;
  // sensor
  DecayLaw decay = DecayLaw::ratio;
  double gain_N_per_V = 0.5, offset_N = -0.1, b_scale = 1.0, q_scale = 1.0;
  double sd_b = 0.05, sd_q = 0.04, sd_gain = 0.003,
         sd_offset_pct = 0.1;  ///< record to record, relative / % of range
  // channels
  int adc_bits = 12;
  double voltage_max_V = 10.0, voltage_noise_V = 0.003, wander_V = 0.002, wander_tau_s = 600.0;
  double reference_step_N = 0.025, reference_noise_N = 0.008, reference_lag_s = 0.002;
  // bench
  double spring_N_per_mm = 0.25, motor_tau_s = 0.02, wheel_radius_mm = 30.0, force_max_N = 4.6;
  bool vary_drive = false, remount = false;
  double climate_swing_C = 1.0, climate_swing_pct = 4.0;
  // what campaign.json says (probability 1 in a tidy lab)
  double documented = 0.8;
  // habits that differ between laboratories
  double session_share =
      0.0;  ///< of the record-to-record variance of gain and offset that a whole session shares
  double gaps_per_hour = 0.0;  ///< rows that the logger lost; its stamps tell
  bool short_protocol = false, long_protocol = false;
  bool wide_loads = false;  ///< small amplitudes, slow and fast sines, long sines of unequal length
  bool roles_given = true;
};

Conditions draw_conditions(std::uint64_t seed, const ConditionNeeds& needs);

}  // namespace forcegate::hidden
