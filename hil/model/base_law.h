#pragma once
// The starting model (Lebosse 2011): static law F = G U + F0 (eq. 1) and the decay of the maxima (eq. 3-5, 7) in the
// ratio form, the only one free of contradiction:
//
//   U = (Fmin + D (F - Fmin) - F0)/G,   D = (exp(-b t) + q)/(1 + q) in dynamic records, 1 in static ones
//   b = b_scale (0.0019 f + 0.0056) 1/s,   q = c/a = q_scale / (1 + 1.377 A^2),   t from the start of the excitation,
//   or in part by the loading done since then
//
// f in Hz: lowest frequency at the start; A in N: half the peak-to-peak force; Fmin in N: lowest settled force.

#include "hil/model/record_input.h"

namespace forcegate {

struct BaseLaw {
  double gain_N_per_V = 0.5;  ///< G
  double offset_N = 0.0;      ///< F0
  double b_slope = 0.0019, b_intercept_per_s = 0.0056;
  double q_curvature = 1.377;  ///< 1/N^2
  double b_scale = 1.0, q_scale = 1.0;
  double loading_share = 0.0;  ///< of the decay's clock, 0 to 1: p of hil/model/decay_clock.h
  bool decays = true;  ///< false: D = 1 everywhere (FSR and plain static sensors)

  double decay_rate_per_s(double f_Hz) const { return b_scale * (b_slope * f_Hz + b_intercept_per_s); }
  double depth_ratio(double A_N) const { return q_scale / (1.0 + q_curvature * A_N * A_N); }
};

/// D at `since_s` after the start of the excitation.
double decay_factor(double since_s, double b_per_s, double q);

/// Fills record.decay with the rates multiplied by the record's own factors, along its clock (hil/model/decay_clock.h).
void set_decay(RecordInput& record, const BaseLaw& law, double log_b_shift = 0.0, double log_q_shift = 0.0);

/// Base output of every row, volts.
std::vector<double> base_output_V(const RecordInput& record, const BaseLaw& law);

}  // namespace forcegate
