#include "hil/diagnose/physical_parameters.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

RecordInput trial(std::vector<double> t_s, std::vector<double> F_N) {
  RecordInput r;
  const std::size_t n = t_s.size();
  r.t_s = r.fast_t_s = std::move(t_s);
  r.F_N = r.fast_F_N = r.rig_force_N = std::move(F_N);
  r.U_V.assign(n, 0.0);
  r.rate_N_per_s.assign(n, 0.0);
  r.travel_N.assign(n, 0.0);
  r.ok.assign(n, 1);
  r.decay.assign(n, 1.0);
  for (std::size_t i = 0; i <= n; ++i) r.row_begin.push_back(static_cast<std::uint32_t>(i));
  r.duration_s = r.t_s.back();
  return r;
}

// Newtons that the finding adds on the rows of a trial, as a linear function of the fit's coefficients.
Eigen::MatrixXd response(const CampaignInput& campaign, const ResidualChannel& channel,
                         const ChosenEffect& chosen, const RecordInput& r) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(static_cast<Index>(r.rows()), chosen.fit.coefficient.size());
  std::vector<int> variants = {chosen.variant};
  variants.insert(variants.end(), chosen.further.begin(), chosen.further.end());
  for (const int v : variants) {
    const Variant& variant = channel.variants[static_cast<std::size_t>(v)];
    const Candidate& c = channel.candidates[static_cast<std::size_t>(variant.candidate)];
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Index>(r.rows()), c.count);
    c.form->columns(campaign, r, c.shape, columns);
    for (std::size_t b = 0; b < chosen.fit.columns.size(); ++b)
      for (const int j : variant.columns)
        if (chosen.fit.columns[b] == j)
          out.col(channel.problem.n_fixed + static_cast<Index>(b)) = columns.col(j - c.first);
  }
  return out;
}

FoundParameter estimate(const ChosenEffect& chosen, const VectorXd& of, double scale, std::string name,
                        std::string unit) {
  const double variance = of.dot(chosen.fit.covariance * of);
  return {std::move(name), scale * of.dot(chosen.fit.coefficient),
          std::abs(scale) * std::sqrt(std::max(0.0, variance)), std::move(unit)};
}

std::vector<FoundParameter> growth(const CampaignInput& campaign, const ResidualChannel& channel,
                                   const ChosenEffect& chosen) {
  double longest = 10.0;
  for (const RecordInput& r : campaign.records) longest = std::max(longest, r.duration_s);
  const double until = std::min(100.0, longest), load_N = campaign.range_N;
  std::vector<double> t = {0.0}, F = {0.0};
  constexpr int kSteps = 400;
  Index at_one_s = 0;
  for (int k = 0; k <= kSteps; ++k) {
    t.push_back(1e-3 * std::pow(until / 1e-3, static_cast<double>(k) / kSteps));
    F.push_back(load_N);
    if (t.back() <= 1.0) at_one_s = static_cast<Index>(t.size()) - 1;
  }
  const double decades = std::log10(until / t[static_cast<std::size_t>(at_one_s)]);
  const Eigen::MatrixXd added = response(campaign, channel, chosen, trial(std::move(t), std::move(F)));
  const VectorXd last = added.row(added.rows() - 1), first = added.row(at_one_s);
  return {estimate(chosen, last - first, 1.0 / (load_N * decades), "growth_per_decade", "1/decade"),
          estimate(chosen, last, 1.0 / load_N,
                   "growth_in_" + std::to_string(static_cast<int>(std::lround(until))) + "s", "1")};
}

std::vector<FoundParameter> width(const CampaignInput& campaign, const ResidualChannel& channel,
                                  const ChosenEffect& chosen) {
  constexpr int kBranch = 400;
  std::vector<double> t, F;
  for (int k = 0; k <= 3 * kBranch; ++k) {  // up, down, up again
    const double x = static_cast<double>(k % (2 * kBranch)) / kBranch;
    t.push_back(0.02 * k);
    F.push_back(campaign.lowest_N + campaign.range_N * (x <= 1.0 ? x : 2.0 - x));
  }
  const Eigen::MatrixXd added = response(campaign, channel, chosen, trial(std::move(t), std::move(F)));
  const VectorXd across = (added.row(kBranch + kBranch / 2) - added.row(2 * kBranch + kBranch / 2)).transpose();
  return {estimate(chosen, across, 1.0, "loop_width_N", "N"),
          estimate(chosen, across, 100.0 / campaign.range_N, "loop_width", "% of span")};
}

}  // namespace

std::vector<FoundParameter> physical_parameters(const CampaignInput& campaign, const ResidualChannel& channel,
                                                const ChosenEffect& chosen) {
  if (EffectRegistry::instance().find(chosen.kind->name) != chosen.kind) return {};
  if (chosen.kind->name == "creep") return growth(campaign, channel, chosen);
  if (chosen.kind->name == "hysteresis" || chosen.kind->name == "backlash") return width(campaign, channel, chosen);
  return {};
}

}  // namespace forcegate::diagnose
