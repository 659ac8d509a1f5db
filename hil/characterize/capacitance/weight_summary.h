#pragma once
// What a study of conductance and capacitance says in numbers, and the paper's claims beside them.

#include <array>
#include <string>
#include <vector>

#include "hil/characterize/capacitance/weight_study.h"

namespace forcegate::characterize {

/// Share of cases, with the 95 % interval of Clopper and Pearson; cases of one pack are taken as independent.
struct ShareOf {
  std::size_t k = 0, n = 0;
  double share() const { return n == 0 ? 0.0 : static_cast<double>(k) / static_cast<double>(n); }
};

struct WeightSummary {
  double per_mean_pct = 0, per_sd_sets_pct = 0, per_se_pct = 0, per_low_pct = 0,
         per_high_pct = 0;  ///< of set means
  double per_sensor_q05 = 0, per_sensor_median = 0, per_sensor_q95 = 0;
  std::array<double, kForceModels> mse_mean{}, mse_q05{}, mse_median{}, mse_q95{}, unloading_mean{};
  // per sensor
  ShareOf network_best, capacitance_below, mean_beats_single, mean_beats_network, ours_beats_network;
  // per set, by the mean over its sensors
  ShareOf set_network_best, set_capacitance_below, set_mean_best;
  // training loadings 1, 2 ...: mean over sets of the reduction against the conductance model of as many loadings
  std::vector<double> per_network_pct, per_ours_pct;
  ShareOf covered, resistance_covered, capacitance_covered, divergence_covered;  ///< at 95 %
  ShareOf flagged_inside, flagged_outside;
  double divergence_low_Hz = 0, divergence_high_Hz = 0,
         divergence_force_pct = 0;  ///< of specimens (mean of forces); mean range over the forces
  double scatter_low_pct = 0,
         scatter_high_pct = 0;  ///< rms of C_s about the fit below 1 kHz and from 1 to 4 kHz
  double operating_median_Hz = 0;
  double u_resistance_pct = 0, u_capacitance_pct = 0, u_divergence_pct = 0,
         u_force_N = 0;  ///< mean stated uncertainty
};

WeightSummary summarise(const WeightStudy& study);

struct WeightClaim {
  std::string place, subject, paper, ours;
  bool has_window = false, inside = true;
  std::string window, why;
};
std::vector<WeightClaim> claims_of(const WeightStudy& study, const WeightSummary& summary);

}  // namespace forcegate::characterize
