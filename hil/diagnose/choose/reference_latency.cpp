#include "hil/diagnose/choose/reference_latency.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "hil/diagnose/base/judge.h"

namespace forcegate::diagnose {

namespace {

constexpr double kOrdinaryLatency_s = 0.012;

bool is_shift(const Candidate& c) { return c.kind->traits.shift == TimeShift::first_shape && !c.shape.empty(); }

bool is_lead(const Candidate& c) { return c.kind->name == kLatencyEffect && c.shape[0] < 0.0; }

}  // namespace

double reference_latency_s(const CampaignInput& input) {
  constexpr double kHigherOrders = 1.75;
  return std::fmax(kOrdinaryLatency_s, kHigherOrders / (2.0 * std::numbers::pi * input.bench.reference_lowpass_Hz));
}

std::string latency_note(const CampaignInput& input) {
  const double latest_s = reference_latency_s(input);
  if (latest_s == kOrdinaryLatency_s) return "the output leads the reference by a few milliseconds, as a reference with its own lag does";
  return fmt::format("the output leads the reference, by no more than the {:.3g} ms that its declared low-pass may be late by", 1e3 * latest_s);
}

double shortest_sample_s(const CampaignInput& input) {
  double out = std::numeric_limits<double>::infinity();
  for (const RecordInput& r : input.records)
    if (const auto n = r.fast_t_s.size(); n > 1) out = std::min(out, (r.fast_t_s.back() - r.fast_t_s.front()) / static_cast<double>(n - 1));
  return std::isfinite(out) ? out : 0.0;
}

double allowed_latency_s(const CampaignInput& input) { return std::max(kOrdinaryLatency_s, 0.5 * shortest_sample_s(input)); }

double shift_s(const ResidualChannel& channel, const FamilyScore& family) {
  const Candidate& c = candidate_of(channel, family.best.variant);
  const double share = family.best.fit.coefficient[family.best.fit.coefficient.size() - 1];
  if (family.kind->traits.shift == TimeShift::percent_lead) return 0.01 * std::abs(share);
  return is_shift(c) ? std::abs(c.shape[0] * share) : 0.0;
}

double net_shift_s(const ResidualChannel& channel, const MixedFit& fit) {
  double out = 0.0;
  for (const int column : fit.columns)
    for (const Candidate& c : channel.candidates)
      if (c.first == column && is_shift(c)) out += c.shape[0] * fit.strength_of(column);
  return out;
}

double rival_lead_s(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family) {
  constexpr double kOfIt = 0.5;  // a shift and a rate part where the force is fast
  for (const FamilyScore& other : result.families)
    if (other.kind->name == kLatencyEffect && is_lead(candidate_of(channel, other.best.variant)) && other.gain > kOfIt * family.gain) return shift_s(channel, other);
  return 0.0;
}

bool is_reference_latency(const ResidualChannel& channel, const FamilyScore& family, double latest_s) {
  return is_lead(candidate_of(channel, family.best.variant)) && shift_s(channel, family) <= latest_s;
}

bool is_nearly_latency(const ResidualChannel& channel, const ScreenResult& result, double latest_s) {
  constexpr double kNearly = 0.8, kLeastGain = 40.0, kMost = 0.5, kLittle = 0.25;
  const FamilyScore& best = result.families.front();
  for (const FamilyScore& family : result.families)
    if (family.kind->name == kLatencyEffect)
      return family.gain > kLeastGain && is_reference_latency(channel, family, latest_s) &&
             (family.gain > kNearly * best.gain || (family.best.fall > kMost && best.best.fall < kLittle));
  return false;
}

bool is_allowed_lead(const Candidate& candidate, double longest_s) {
  return is_lead(candidate) && candidate.shape[0] > -longest_s;
}

void add_leads(const ResidualChannel& channel, std::vector<int>& columns, double longest_s) {
  for (const Candidate& c : channel.candidates)
    if (is_allowed_lead(c, longest_s) && std::find(columns.begin(), columns.end(), c.first) == columns.end())
      columns.push_back(c.first);
}

Eigen::VectorXd strengths_of_leads(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& fit) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(channel.problem.ns);
  for (const Candidate& candidate : channel.candidates)
    if (is_allowed_lead(candidate) && std::ranges::find(columns, candidate.first) != columns.end()) out[candidate.first] = fit.strength_of(candidate.first);
  return out;
}

void take_off_output(ResidualChannel& channel, const Eigen::VectorXd& c) {
  MixedProblem& p = channel.problem;
  const Eigen::Index y = p.y_index();
  const Eigen::Index n = c.size();  // the channel may have become wider since
  if (const Eigen::Index had = channel.taken_off.size(); had < n) {
    channel.taken_off.conservativeResize(n);
    channel.taken_off.tail(n - had).setZero();
  }
  channel.taken_off.head(n) += c;
  // those alone: a column may hold numbers too large to be squared, and nothing times infinity is no number
  std::vector<Eigen::Index> of;
  for (Eigen::Index j = 0; j < n; ++j)
    if (c[j] != 0.0) of.push_back(j);
  for (std::size_t k = 0; k < p.records.size(); ++k) {
    Eigen::MatrixXd& A = channel.rows[k].matrix;
    Eigen::MatrixXd& G = p.records[k].gram;
    Eigen::VectorXd taken = Eigen::VectorXd::Zero(G.rows());  // X' S c, y last
    for (const Eigen::Index j : of) {
      A.col(y) -= c[j] * A.col(p.nz + j);
      taken += c[j] * G.col(p.nz + j);
    }
    double yy = G(y, y) - 2.0 * taken[y];
    for (const Eigen::Index j : of) yy += c[j] * taken[p.nz + j];
    G.col(y) -= taken;
    G.row(y) = G.col(y).transpose();
    G(y, y) = yy;
  }
}

bool depends_on_load(const ResidualChannel& channel, const std::vector<int>& present, const MixedFit& base, const FamilyScore& family) {
  constexpr double kPlain = 100.0;   // nats
  constexpr double kSameKernel = 0.01;  // s: poles as quick as that of the lead, whose strength may turn over
  std::vector<int> columns = present;
  add_leads(channel, columns);
  for (const Candidate& c : channel.candidates)
    if (c.kind->name == "lag" && c.form->name == "one_pole" && c.shape[0] < kSameKernel && std::find(columns.begin(), columns.end(), c.first) == columns.end())
      columns.push_back(c.first);
  const MixedFit with_leads = fit_mixed(channel.problem, columns, &base, 20, base.use);
  if (!with_leads.valid) return false;
  const VariantScore beside = score_variant(channel, columns, with_leads, family.best.variant, nullptr);
  return !beside.wrong_sign && beside.gain > kPlain;
}

MixedFit forgive_late_reference(const Workspace& w, MixedFit base, std::vector<std::string>& notes) {
  constexpr double kLeastGain = 4.0;
  if (w.input.generic && w.input.records.front().row_step_s > kStepsTellNoLag_s) return base;
  const ResidualChannel& channel = w.output;
  std::vector<int> columns = base.columns;
  add_leads(channel, columns);
  if (columns.size() == base.columns.size()) return base;
  MixedFit with = fit_mixed(channel.problem, columns, &base, 20);
  if (!with.valid || with.log_evidence - base.log_evidence < kLeastGain) return base;
  double lead_s = 0.0;
  for (std::size_t b = base.columns.size(); b < columns.size(); ++b)
    for (const Candidate& c : channel.candidates)
      if (c.first == columns[b]) lead_s -= c.shape[0] * with.strength_of(c.first);
  if (lead_s < 0.0 || lead_s > reference_latency_s(w.input)) return base;
  const auto left_out = [&](const MixedFit& fit) {
    return judged(channel, judge(channel, fit, base, w.judges).adapted, w.judges);
  };
  if (left_out(with) >= left_out(base)) return base;
  notes.push_back(latency_note(w.input));
  return with;
}

}  // namespace forcegate::diagnose
