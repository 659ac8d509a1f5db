#include "hil/diagnose/answer/physical_parameters.h"

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

// What the finding adds on the rows of a trial, newtons, and its derivatives with respect to coefficients and shapes.
struct Response {
  VectorXd added;
  Eigen::MatrixXd derivative;
  const ShapeCovariance& joint;

  FoundParameter at(Index row, double scale, std::string name, std::string unit) const {
    return told(added[row], derivative.row(row), scale, std::move(name), std::move(unit));
  }
  FoundParameter difference(Index row, Index less, double scale, std::string name, std::string unit) const {
    return told(added[row] - added[less], derivative.row(row) - derivative.row(less), scale, std::move(name), std::move(unit));
  }

 private:
  FoundParameter told(double value_N, const VectorXd& of, double scale, std::string name, std::string unit) const {
    return {std::move(name), scale * value_N, std::abs(scale) * std::sqrt(std::max(0.0, of.dot(joint.covariance * of))), std::move(unit)};
  }
};

Response response(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen, const ShapeCovariance& joint,
                  const RecordInput& r) {
  const auto rows = static_cast<Index>(r.rows());
  const Index n = chosen.fit.coefficient.size();
  Response out{{}, Eigen::MatrixXd::Zero(rows, joint.covariance.rows()), joint};
  std::vector<int> variants = {chosen.variant};
  variants.insert(variants.end(), chosen.further.begin(), chosen.further.end());
  for (const int v : variants) {
    const Candidate& c = candidate_of(channel, v);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, c.count);
    c.form->columns(campaign, r, c.shape, columns);
    for (const int j : columns_of(channel, v))
      if (const auto at = chosen.fit.place_of(j)) out.derivative.col(*at) = columns.col(j - c.first);
  }
  out.added = out.derivative.leftCols(n) * chosen.fit.coefficient;
  for (std::size_t s = 0; s < joint.shapes.size(); ++s)
    out.derivative.col(n + static_cast<Index>(s)) = shape_derivative(campaign, channel, chosen.fit, joint.shapes[s], r);
  return out;
}

std::vector<FoundParameter> growth(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen,
                                   const ShapeCovariance& joint) {
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
  const Response added = response(campaign, channel, chosen, joint, trial(std::move(t), std::move(F)));
  const Index unloaded = 0, last = added.added.size() - 1;
  return {added.difference(last, at_one_s, 1.0 / (load_N * decades), "growth_per_decade", "1/decade"),
          added.difference(last, unloaded, 1.0 / load_N, "growth_in_" + std::to_string(static_cast<int>(std::lround(until))) + "s", "1")};
}

std::vector<FoundParameter> width(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen,
                                  const ShapeCovariance& joint) {
  constexpr int kBranch = 400;
  std::vector<double> t, F;
  for (int k = 0; k <= 3 * kBranch; ++k) {  // up, down, up again
    const double x = static_cast<double>(k % (2 * kBranch)) / kBranch;
    t.push_back(0.02 * k);
    F.push_back(campaign.lowest_N + campaign.range_N * (x <= 1.0 ? x : 2.0 - x));
  }
  const Response added = response(campaign, channel, chosen, joint, trial(std::move(t), std::move(F)));
  if (added.derivative.isZero(0.0)) return {};  // what goes with the angle has no width over the force
  // in the middle of the range; where a loop of no one shape is widest
  Index half = kBranch / 2;
  const auto width_at = [&](Index rise) { return std::abs(added.added[2 * kBranch + rise] - added.added[2 * kBranch - rise]); };
  if (candidate_of(channel, chosen.variant).form->last)
    for (Index rise = kBranch / 8; rise <= kBranch - kBranch / 8; ++rise)
      if (width_at(rise) > width_at(half)) half = rise;
  const Index up = 2 * kBranch - half, down = 2 * kBranch + half;
  return {added.difference(up, down, 1.0, "loop_width_N", "N"), added.difference(up, down, 100.0 / campaign.range_N, "loop_width", "% of span")};
}

// Of a lag: its forms have several poles at most.
double slowest_s(const ResidualChannel& channel, const ChosenEffect& chosen) {
  double out = 0.0;
  std::vector<int> variants = {chosen.variant};
  variants.insert(variants.end(), chosen.further.begin(), chosen.further.end());
  for (const int v : variants) {
    const Candidate& c = candidate_of(channel, v);
    for (std::size_t k = 0; k < c.shape.size(); ++k)
      if (c.form->shape[k].unit == "s") out = std::max(out, std::abs(c.shape[k]));
  }
  return out;
}

// Behind a steady ramp, far from its ends: a lead has no force to read behind the last row, and a lag is behind by its time only when that is long
// over. A loss of rate shows between two places.
std::vector<FoundParameter> behind(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen,
                                   const ShapeCovariance& joint) {
  constexpr int kSteps = 4000, kLate = 3 * kSteps / 4;
  constexpr double kRate_N_per_s = 1.0, kLongOver = 20.0;
  const double step_s = std::max(0.01, chosen.kind->name == "lag" ? kLongOver * slowest_s(channel, chosen) / kLate : 0.0);
  std::vector<double> t, F;
  for (int k = 0; k <= kSteps; ++k) {
    t.push_back(step_s * k);
    F.push_back(kRate_N_per_s * t.back());
  }
  RecordInput ramp = trial(std::move(t), std::move(F));
  ramp.lost_blocks = {{0.0, 1.0}};
  const Response added = response(campaign, channel, chosen, joint, ramp);
  if (candidate_of(channel, chosen.variant).form->name == "lost_blocks") return {added.at(kLate, -1.0 / kRate_N_per_s, "block_s", "s")};
  if (chosen.kind->name == "clock_skew")
    return {added.difference(kLate, kSteps / 2, -1.0 / (kRate_N_per_s * step_s * (kLate - kSteps / 2)), "skew", "1")};
  return {added.at(kLate, -1.0 / kRate_N_per_s, chosen.kind->name + "_s", "s")};
}

}  // namespace

std::vector<FoundParameter> physical_parameters(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen,
                                                const ShapeCovariance& joint) {
  const std::string& name = chosen.kind->name;
  if (EffectRegistry::instance().find(name) != chosen.kind) return {};
  const bool runs_on = candidate_of(channel, chosen.variant).form->outlasts;  // a time constant of its own
  if (name == "creep" && !runs_on) return growth(campaign, channel, chosen, joint);
  if (name == "hysteresis" || name == "backlash") return width(campaign, channel, chosen, joint);
  if (name == "delay" || name == "lag" || name == "clock_skew") return behind(campaign, channel, chosen, joint);
  return {};
}

}  // namespace forcegate::diagnose
