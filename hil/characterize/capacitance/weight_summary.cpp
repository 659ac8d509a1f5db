#include "hil/characterize/capacitance/weight_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

constexpr double k95 = 1.959963984540054;
constexpr double kPerPaper_pct = 64.0, kPerWindow_pct = 8.0;

void tally(ShareOf& share, bool yes) {
  ++share.n;
  share.k += yes ? 1 : 0;
}

std::string percent(const ShareOf& s) {
  const Interval95 i = clopper_pearson_95(s.k, s.n);
  return fmt::format("{:.1f} % ({} of {}; 95 %: {:.1f} to {:.1f})", 100.0 * s.share(), s.k, s.n,
                     100.0 * i.low, 100.0 * i.high);
}

struct Sweeps {
  double low = 0, high = 0, u_r = 0, u_c = 0, u_d = 0, force = 0;
  std::size_t n_low = 0, n_high = 0, n = 0, n_force = 0, n_d = 0;
};

void take_sweeps(const SensorResult& sensor, WeightSummary& out, Sweeps& sums) {
  double mean_Hz = 0, least_Hz = INFINITY, most_Hz = 0;
  std::size_t found = 0;
  for (const SweepResult& s : sensor.sweeps) {
    if (!s.fitted) {
      tally(out.resistance_covered, false);
      tally(out.capacitance_covered, false);
      continue;
    }
    const auto& f = s.fit;
    if (std::isfinite(s.true_conductance_S)) {
      tally(out.resistance_covered, std::abs(1.0 / f.conductance_S - 1.0 / s.true_conductance_S) <=
                                        k95 * f.u_conductance_S / (f.conductance_S * f.conductance_S));
      tally(out.capacitance_covered,
            std::abs(f.capacitance_F - s.true_capacitance_F) <= k95 * f.u_capacitance_F);
      tally(out.divergence_covered,
            std::abs(f.divergence_Hz - s.true_divergence_Hz) <= k95 * f.u_divergence_Hz);
    }
    out.flagged_inside.k += s.flagged_inside, out.flagged_inside.n += s.inside;
    out.flagged_outside.k += s.flagged_outside, out.flagged_outside.n += s.outside;
    sums.u_r += 100.0 * f.u_conductance_S / f.conductance_S,
        sums.u_c += 100.0 * f.u_capacitance_F / f.capacitance_F, ++sums.n;
    for (const auto& r : s.readings) {
      if (r.saturated || r.f_Hz > 4000.0) continue;
      const double off_pct = 100.0 * (r.capacitance_F / f.capacitance_F - 1.0);
      if (r.f_Hz < 1000.0)
        sums.low += off_pct * off_pct, ++sums.n_low;
      else if (r.f_Hz <= 0.4 * f.divergence_Hz)
        sums.high += off_pct * off_pct, ++sums.n_high;
    }
    if (!std::isfinite(f.divergence_Hz)) continue;
    sums.u_d += 100.0 * f.u_divergence_Hz / f.divergence_Hz, ++sums.n_d;
    mean_Hz += f.divergence_Hz, ++found;
    least_Hz = std::min(least_Hz, f.divergence_Hz), most_Hz = std::max(most_Hz, f.divergence_Hz);
  }
  if (found == 0) return;
  mean_Hz /= static_cast<double>(found);
  out.divergence_low_Hz = out.divergence_low_Hz == 0.0 ? mean_Hz : std::min(out.divergence_low_Hz, mean_Hz);
  out.divergence_high_Hz = std::max(out.divergence_high_Hz, mean_Hz);
  sums.force += 100.0 * (most_Hz - least_Hz) / mean_Hz, ++sums.n_force;
}

void take_orders(const std::array<double, kForceModels>& mse, WeightSummary& out) {
  tally(out.network_best, mse[3] < std::min({mse[0], mse[1], mse[2]}));
  tally(out.capacitance_below, mse[1] < mse[0]);
  tally(out.mean_beats_single, mse[2] < std::min(mse[0], mse[1]));
  tally(out.mean_beats_network, mse[2] < mse[3]);
  tally(out.ours_beats_network, mse[4] < mse[3]);
}

}  // namespace

WeightSummary summarise(const WeightStudy& study) {
  WeightSummary out;
  Sweeps sums;
  std::vector<double> set_per, sensor_per, operating;
  std::array<std::vector<double>, kForceModels> mse;
  std::vector<double> network(study.plan.most_training, 0.0), ours = network;
  double sensors = 0.0;
  for (const SetResult& set : study.sets) {
    std::array<double, kForceModels> mean{};
    for (const SensorResult& s : set.sensors) {
      sensors += 1.0;
      sensor_per.push_back(s.per_pct);
      take_orders(s.mse_N2, out);
      for (std::size_t m = 0; m < kForceModels; ++m) {
        mean[m] += s.mse_N2[m];
        mse[m].push_back(s.mse_N2[m]);
        out.unloading_mean[m] += s.unloading_mse_N2[m];
      }
      for (std::size_t n = 0; n < network.size(); ++n) {
        network[n] += impedance::error_reduction_pct(s.network_mse_N2[n], s.conductance_mse_N2[n]);
        ours[n] += impedance::error_reduction_pct(s.ours_mse_N2[n], s.conductance_mse_N2[n]);
      }
      out.covered.k += s.covered, out.covered.n += s.tested;
      out.u_force_N += s.u_mean_N;
      take_sweeps(s, out, sums);
    }
    set_per.push_back(set.per_mean_pct());
    operating.push_back(set.operating_Hz);
    tally(out.set_network_best, mean[3] < std::min({mean[0], mean[1], mean[2]}));
    tally(out.set_capacitance_below, mean[1] < mean[0]);
    tally(out.set_mean_best, mean[2] < std::min({mean[0], mean[1], mean[3]}));
  }
  for (std::size_t n = 0; n < network.size(); ++n)
    out.per_network_pct.push_back(network[n] / sensors), out.per_ours_pct.push_back(ours[n] / sensors);
  for (std::size_t m = 0; m < kForceModels; ++m) {
    out.mse_mean[m] = moments(mse[m]).mean;
    out.mse_q05[m] = sample_quantile(mse[m], 0.05), out.mse_median[m] = sample_quantile(mse[m], 0.5),
    out.mse_q95[m] = sample_quantile(mse[m], 0.95);
    out.unloading_mean[m] /= sensors;
  }
  out.u_force_N /= sensors;
  const Moments per = moments(set_per);
  out.per_mean_pct = per.mean;
  out.per_sd_sets_pct = per.sd;
  out.per_se_pct = per.sd / std::sqrt(static_cast<double>(per.n));
  out.per_low_pct = *std::min_element(set_per.begin(), set_per.end());
  out.per_high_pct = *std::max_element(set_per.begin(), set_per.end());
  out.per_sensor_q05 = sample_quantile(sensor_per, 0.05),
  out.per_sensor_median = sample_quantile(sensor_per, 0.5),
  out.per_sensor_q95 = sample_quantile(sensor_per, 0.95);
  out.scatter_low_pct = std::sqrt(sums.low / static_cast<double>(sums.n_low));
  out.scatter_high_pct = std::sqrt(sums.high / static_cast<double>(sums.n_high));
  out.u_resistance_pct = sums.u_r / static_cast<double>(sums.n);
  out.u_capacitance_pct = sums.u_c / static_cast<double>(sums.n);
  out.u_divergence_pct = sums.u_d / static_cast<double>(sums.n_d);
  out.divergence_force_pct = sums.force / static_cast<double>(sums.n_force);
  out.operating_median_Hz = sample_quantile(operating, 0.5);
  return out;
}

std::vector<WeightClaim> claims_of(const WeightStudy& study, const WeightSummary& s) {
  std::vector<WeightClaim> out;
  out.push_back({"VI, Table I", "Mean percentage of error reduction, eq. (11), of a pack of eight", "64 %",
                 fmt::format("{:.1f} % ± {:.1f} (standard error {:.1f}; packs {:.1f} to {:.1f}, {} of them)",
                             s.per_mean_pct, s.per_sd_sets_pct, s.per_se_pct, s.per_low_pct, s.per_high_pct,
                             study.sets.size()),
                 true, std::abs(s.per_mean_pct - kPerPaper_pct) <= kPerWindow_pct, "56 to 72 %",
                 "the network of the same training data, see the table of training loadings"});
  out.push_back({"VI, Table I", "... of single sensors", "39.7 to 88.8 %",
                 fmt::format("5 % quantile {:.1f} %, median {:.1f} %, 95 % quantile {:.1f} %",
                             s.per_sensor_q05, s.per_sensor_median, s.per_sensor_q95),
                 false, true, "", "some sensors have little to gain: their conductance is already good"});
  out.push_back({"VI, Table I", "MSE of the conductance model", "0.258 to 2.01 N²",
                 fmt::format("{:.3f} to {:.2f} N² (5 to 95 %), median {:.3f}", s.mse_q05[0], s.mse_q95[0],
                             s.mse_median[0]),
                 false, true, "", "drawn from this spread"});
  out.push_back({"VI, Table I", "MSE of the network", "0.107 to 0.515 N²",
                 fmt::format("{:.3f} to {:.3f} N² (5 to 95 %), median {:.3f}", s.mse_q05[3], s.mse_q95[3],
                             s.mse_median[3]),
                 false, true, "", "ours repeats better than theirs"});
  out.push_back({"VI, Fig. 10", "Capacitance model below the conductance model", "all eight sensors",
                 percent(s.capacitance_below), true, s.capacitance_below.share() > 0.5, "most sensors", ""});
  out.push_back({"VI, Fig. 10", "... by the mean over a pack", "yes", percent(s.set_capacitance_below), true,
                 s.set_capacitance_below.share() > 0.5, "most packs", ""});
  out.push_back(
      {"VI, Fig. 10", "Network best of the four models", "seven of eight sensors", percent(s.network_best),
       true, s.network_best.share() > 0.5, "most sensors",
       "three loadings hardly carry nine weights: some networks learn the accidents of their training"});
  out.push_back({"VI, Fig. 10", "... by the mean over a pack", "yes", percent(s.set_network_best), true,
                 s.set_network_best.share() > 0.5, "most packs", ""});
  out.push_back({"VI, Fig. 10", "Mean of both models better than either", "three of eight sensors",
                 percent(s.mean_beats_single), true,
                 s.mean_beats_single.share() < 0.5 && s.mean_beats_single.k > 0, "sometimes", ""});
  out.push_back({"VI, Fig. 10", "Mean of both models better than the network", "one of eight sensors",
                 percent(s.mean_beats_network), true, s.mean_beats_network.share() < 0.5, "seldom", ""});
  out.push_back({"V-A, Fig. 6", "Divergence frequency of the specimens", "4.5 to 7 kHz",
                 fmt::format("{:.2f} to {:.2f} kHz, stated to {:.1f} %", 1e-3 * s.divergence_low_Hz,
                             1e-3 * s.divergence_high_Hz, s.u_divergence_pct),
                 true, s.divergence_low_Hz > 4000.0 && s.divergence_high_Hz < 7500.0, "4 to 7.5 kHz",
                 "the paper reads it by eye; ours is where tan(phi) has fallen to 5/6 of eq. (9)"});
  out.push_back({"V-A, Fig. 6", "... its range over 50, 125 and 250 N", "only slight variation",
                 fmt::format("{:.1f} %", s.divergence_force_pct), true, s.divergence_force_pct < 10.0,
                 "below 10 %", ""});
  out.push_back({"V-A, Fig. 7", "Scatter of C_s below 1 kHz, and from 1 kHz to 0.4 of the divergence",
                 "scattered below 1 kHz",
                 fmt::format("{:.2f} %, and {:.2f} %", s.scatter_low_pct, s.scatter_high_pct), true,
                 s.scatter_low_pct > 2.0 * s.scatter_high_pct, "more than twice",
                 "noise of the reading: at low frequency the capacitive current is small"});
  out.push_back({"V-B", "Frequency to work at", "4 kHz chosen",
                 fmt::format("{:.2f} kHz recommended (median of packs)", 1e-3 * s.operating_median_Hz), false,
                 true, "", "below 0.9 of the lowest divergence of the pack less 2 u"});
  out.push_back({"-", "R_s of the Bode fit within its stated 95 % interval", "-",
                 percent(s.resistance_covered) + fmt::format(", u {:.2f} %", s.u_resistance_pct),
                 s.resistance_covered.n > 0, s.resistance_covered.share() >= 0.92, "at least 92 %",
                 "truth of the emulated bench"});
  out.push_back({"-", "C_s of the Bode fit within its stated 95 % interval", "-",
                 percent(s.capacitance_covered) + fmt::format(", u {:.2f} %", s.u_capacitance_pct),
                 s.capacitance_covered.n > 0, s.capacitance_covered.share() >= 0.92, "at least 92 %",
                 "R_g is known to 0.1 %, which makes most of u"});
  out.push_back({"-", "Divergence frequency within its stated 95 % interval", "-",
                 percent(s.divergence_covered), s.divergence_covered.n > 0,
                 s.divergence_covered.share() >= 0.92, "at least 92 %",
                 "the same definition applied to the true admittance"});
  out.push_back({"-", "Readings flagged as departing, 1 kHz to 0.4 of the divergence", "-",
                 percent(s.flagged_inside), true, s.flagged_inside.share() < 0.02, "below 2 %", ""});
  out.push_back({"-", "Readings flagged as departing, above 1.5 times the divergence", "-",
                 percent(s.flagged_outside), true, s.flagged_outside.share() > 0.98, "above 98 %", ""});
  out.push_back({"-", "Force by two variables (ours) within its stated 95 % interval, new loadings", "-",
                 percent(s.covered) + fmt::format(", u {:.2f} N", s.u_force_N), true,
                 s.covered.share() >= 0.93, "at least 93 %",
                 "the interval of n above takes readings of one loading as independent, which they are not"});
  for (WeightClaim& claim : out)  // a mean of none: no sweep could be fitted
    if (claim.ours.find("nan") != std::string::npos) claim.ours = "not measured", claim.inside = !claim.has_window;
  return out;
}

}  // namespace forcegate::characterize
