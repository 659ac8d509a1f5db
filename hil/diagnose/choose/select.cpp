#include "hil/diagnose/choose/select.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/left_out.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/choose/forward_choice.h"
#include "hil/diagnose/choose/further_forms.h"
#include "hil/diagnose/choose/in_place.h"
#include "hil/diagnose/choose/needless.h"
#include "hil/diagnose/choose/reconsider.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/refit_chosen.h"

namespace forcegate::diagnose {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd contribution(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns) {
  VectorXd out = VectorXd::Zero(channel.problem.ns);
  for (const int column : columns) out[column] = fit.strength_of(column);
  return out;
}

}  // namespace

std::vector<int> columns_of(const ResidualChannel& channel, const ChosenEffect& effect) {
  std::vector<int> out = effect.columns;
  for (const int further : effect.further) add_columns(out, columns_of(channel, further));
  return out;
}

namespace {

// The model that the findings describe, effect by effect.
void fit_claimed(const ResidualChannel& channel, Selection& out) {
  std::vector<int> present = out.base.columns;
  out.claimed = out.base;
  for (ChosenEffect& chosen : out.chosen) {
    add_columns(present, chosen.columns);
    MixedFit fit = fit_mixed(channel.problem, present, &out.claimed, 12, RecordUse::all_records);
    if (chosen.between && chosen.fit.valid) {  // from the spreads that it left when it was chosen
      MixedFit other = fit_mixed(channel.problem, present, &chosen.fit, 12, RecordUse::all_records);
      if (other.valid && (!fit.valid || other.log_evidence > fit.log_evidence)) fit = std::move(other);
    }
    if (!fit.valid) return;
    if (!chosen.between) chosen.further = further_forms(channel, *chosen.kind, present, fit);
    chosen.fit = out.claimed = std::move(fit);
  }
}

// What is reported comes from the fit records alone.
void report_selection(const ResidualChannel& channel, Selection& out) {
  fit_claimed(channel, out);
  const auto report = [&](MixedFit& fit) {
    const MixedFit refitted = fit_mixed(channel.problem, fit.columns, &fit, 8);
    if (refitted.valid) fit = refitted;
  };
  report(out.base);
  report(out.final);
  report(out.claimed);
  for (ChosenEffect& chosen : out.chosen) report(chosen.fit);
}

// A late reference that shows only beside the effects is none of what the starting model misses either: it goes as the final model tells it.
void set_lateness_aside(ResidualChannel& channel, const std::vector<int>& carried, Selection& out) {
  std::vector<int> beside;
  for (const int j : carried)
    if (std::ranges::find(out.base.columns, j) == out.base.columns.end()) beside.push_back(j);
  const Eigen::VectorXd late = strengths_of_leads(channel, beside, out.final);
  if (out.chosen.empty() || !out.final.valid || late.isZero()) return;
  take_off_output(channel, late);
  const MixedFit base = fit_to_the_end(channel, out.base.columns, &out.base, 18, RecordUse::all_records);
  const MixedFit final = fit_mixed(channel.problem, out.final.columns, &out.final, 12, RecordUse::all_records);
  if (!base.valid || !final.valid) return take_off_output(channel, -late);
  out.set_aside = late;
  out.base = base;
  out.final = final;
  out.excess_before = excess_mean_square(channel, base);
  out.excess_after = excess_mean_square(channel, final);
}

// Of one recording that all of them together describe.
void find_what_completes_whole(const CampaignInput& input, const ResidualChannel& channel, Selection& out) {
  if (out.chosen.size() < 2 || !describes_whole(input, channel, out.base, out.final)) return;
  for (ChosenEffect& chosen : out.chosen) {
    std::vector<int> own = chosen.columns, without;
    add_columns(own, family_columns(channel, *chosen.kind));
    for (const int j : out.final.columns)
      if (std::ranges::find(own, j) == own.end()) without.push_back(j);
    const MixedFit reduced = fit_mixed(channel.problem, without, &out.final, 12, RecordUse::all_records);
    chosen.completes_whole = reduced.valid && !describes_whole(input, channel, out.base, reduced);
  }
}

}  // namespace

double log_prior(const EffectKind& kind, const SelectionRules& rules) { return kind.name == rules.expected ? std::log(kExpectedOdds) : 0.0; }

double threshold_of(const std::string& effect, const SelectionRules& rules) {
  return is_between_records(effect) ? rules.between_gain : rules.first_gain;
}

void add_columns(std::vector<int>& to, const std::vector<int>& columns) {
  for (int j : columns)
    if (std::find(to.begin(), to.end(), j) == to.end()) to.push_back(j);
}

std::vector<int> columns_beside(const ResidualChannel& channel, const std::vector<int>& carried, const std::vector<ChosenEffect>& chosen, const ChosenEffect& one) {
  std::vector<int> out = carried;
  for (const ChosenEffect& other : chosen) {
    if (&other == &one) continue;
    add_columns(out, columns_of(channel, other));
    add_columns(out, bank_columns(channel, *other.kind));
  }
  return out;
}

std::vector<int> bank_columns(const ResidualChannel& channel, const EffectKind& kind) {
  std::vector<int> out;
  for (const Candidate& c : channel.candidates)
    if (c.kind == &kind && c.form->bank)
      for (int j = 0; j < c.count; ++j) out.push_back(c.first + j);
  return out;
}

std::vector<int> family_columns(const ResidualChannel& channel, const EffectKind& kind) {
  constexpr std::size_t kMost = 28;
  std::vector<int> out = bank_columns(channel, kind);
  for (const Candidate& c : channel.candidates)
    if (c.kind == &kind && !c.form->bank)
      for (int j = 0; j < c.count && out.size() < kMost; ++j) out.push_back(c.first + j);
  return out;
}

double signature_cosine(const ResidualChannel& channel, const MixedFit& base, const MixedFit& fit_a,
                        const std::vector<int>& columns_a, const MixedFit& fit_b, const std::vector<int>& columns_b) {
  const MixedProblem& p = channel.problem;
  const VectorXd a = contribution(channel, fit_a, columns_a), b = contribution(channel, fit_b, columns_b);
  VectorXd sigma2(p.nz);
  for (int j = 0; j < p.nz; ++j) sigma2[j] = base.variance[p.component_of_z[j]];
  MatrixXd M = MatrixXd::Zero(p.n_fixed + 2, p.n_fixed + 2);
  for (std::size_t i = 0; i < p.records.size(); ++i) {
    if (p.records[i].heldout) continue;
    const auto& G = p.records[i].gram;
    const MatrixXd zz = G.topLeftCorner(p.nz, p.nz);
    MatrixXd zc(p.nz, p.n_fixed + 2);
    zc.leftCols(p.n_fixed) = zz.leftCols(p.n_fixed);
    const auto zs = G.block(0, p.nz, p.nz, p.ns);
    zc.col(p.n_fixed) = zs * a;
    zc.col(p.n_fixed + 1) = zs * b;
    MatrixXd cc = MatrixXd::Zero(p.n_fixed + 2, p.n_fixed + 2);
    cc.topLeftCorner(p.n_fixed, p.n_fixed) = zz.topLeftCorner(p.n_fixed, p.n_fixed);
    cc.block(0, p.n_fixed, p.n_fixed, 2) = zc.block(0, p.n_fixed, p.n_fixed, 2);
    cc.block(p.n_fixed, 0, 2, p.n_fixed) = cc.block(0, p.n_fixed, p.n_fixed, 2).transpose();
    const auto ss = G.block(p.nz, p.nz, p.ns, p.ns);
    cc(p.n_fixed, p.n_fixed) = a.dot(ss * a);
    cc(p.n_fixed, p.n_fixed + 1) = cc(p.n_fixed + 1, p.n_fixed) = a.dot(ss * b);
    cc(p.n_fixed + 1, p.n_fixed + 1) = b.dot(ss * b);
    const double weight = p.records[i].n_eff / base.s2[i];
    MatrixXd A = weight * zz;
    A.diagonal() += sigma2.cwiseInverse();
    M += weight * cc - weight * weight * (zc.transpose() * A.llt().solve(zc));
  }
  MatrixXd X = M.topLeftCorner(p.n_fixed, p.n_fixed);
  X.diagonal().array() += 1e-6 * (1.0 + X.diagonal().maxCoeff());
  const MatrixXd left = M.topRightCorner(p.n_fixed, 2);
  const MatrixXd S = M.bottomRightCorner(2, 2) - left.transpose() * X.ldlt().solve(left);
  const double norm = std::sqrt(std::max(0.0, S(0, 0)) * std::max(0.0, S(1, 1)));
  return norm > 0.0 ? S(0, 1) / norm : 0.0;
}

ChosenEffect as_chosen(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                       const SelectionRules& rules) {
  ChosenEffect chosen;
  chosen.kind = family.kind;
  chosen.variant = family.best.variant;
  chosen.columns = columns_of(channel, family.best.variant);
  chosen.gain = family.gain;
  chosen.fall = family.best.fall;
  chosen.excess = excess_mean_square(channel, base);
  chosen.effect_rms = family.best.effect_rms;
  chosen.fit = family.best.fit;
  chosen.left_out = cross_fit(channel, base, family.best.fit);
  chosen.between = moves_levels(candidate_of(channel, family.best.variant)) || asks_between_records(family) || family.records.same_strength;
  chosen.describes_whole = rules.one_zero && !chosen.between && describes_whole(input, channel, base, family.best.fit);
  chosen.records = family.records;
  if (chosen.between) {
    const RecordTest test = test_records(input, channel, base, family, rules);
    chosen.not_by_records = test.objection;
    chosen.chance = test.chance;
  }
  chosen.strength_scatter = strength_scatter(channel.problem, family.best.fit, chosen.columns);
  chosen.seen_in_place = shows_in_place(input, candidate_of(channel, family.best.variant));
  return chosen;
}

Selection select_effects(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                         const SelectionRules& rules, unsigned threads) {
  ForwardChosen forward = choose_forward(input, channel, given, skip, rules, threads);
  Selection out = std::move(forward.selection);
  if (!out.base.valid) return out;

  std::vector<std::string> not_asked = skip;
  if (forward.leads) not_asked.insert(not_asked.end(), {"delay", "lag"});
  reconsider(input, channel, forward.carried, not_asked, rules, threads, out);
  if (rules.one_zero) find_what_completes_whole(input, channel, out);
  drop_needless(channel, forward.carried, rules, out);
  if (forward.leads) set_lateness_aside(channel, forward.carried, out);
  out.carried = forward.carried;
  report_selection(channel, out);
  return out;
}

void leave_out(const ResidualChannel& channel, const std::function<bool(const ChosenEffect&)>& goes, Selection& selection) {
  if (std::erase_if(selection.chosen, goes) == 0) return;
  refit_chosen(channel, selection.carried, selection);
  report_selection(channel, selection);
}

}  // namespace forcegate::diagnose
