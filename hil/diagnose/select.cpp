#include "hil/diagnose/select.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/between_records.h"
#include "hil/diagnose/further_forms.h"
#include "hil/diagnose/left_out.h"
#include "hil/diagnose/needless.h"
#include "hil/diagnose/objection.h"
#include "hil/diagnose/reference_latency.h"
#include "hil/diagnose/reconsider.h"
#include "hil/diagnose/refine.h"
#include "hil/diagnose/shares.h"

namespace forcegate::diagnose {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd contribution(const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& columns) {
  VectorXd out = VectorXd::Zero(channel.problem.ns);
  for (std::size_t b = 0; b < fit.columns.size(); ++b)
    if (std::find(columns.begin(), columns.end(), fit.columns[b]) != columns.end())
      out[fit.columns[b]] = fit.coefficient[channel.problem.n_fixed + static_cast<Eigen::Index>(b)];
  return out;
}

bool is_late(const std::string& name) { return name == "delay" || name == "lag"; }

// The model that the findings describe, effect by effect.
void fit_claimed(const ResidualChannel& channel, Selection& out) {
  std::vector<int> present = out.base.columns;
  out.claimed = out.base;
  for (ChosenEffect& chosen : out.chosen) {
    add_columns(present, chosen.columns);
    MixedFit fit = fit_mixed(channel.problem, present, &out.claimed, 12, RecordUse::all_records);
    if (!fit.valid) return;
    if (!chosen.between) chosen.further = further_forms(channel, *chosen.kind, present, fit);
    chosen.fit = out.claimed = std::move(fit);
  }
}

}  // namespace

// Record-level effects change gains and offsets between records: the records' own freedom absorbs them, so that only
// the prediction without that freedom can tell.
bool is_between_records(const std::string& name) {
  return name == "wear" || name == "thermal" || name == "humidity" || name == "bias" || name == "mounting" ||
         name == "slow_recovery" || name == "reference_drift";
}

// Two instruments are never in step to the last milliseconds, so that a small shift which stays within what the declared
// noise allows is nobody's fault.
bool is_timing(const std::string& name) {
  return name == "delay" || name == "lag" || name == "rc" || name == "clock_skew" || name == "piezocapacitance";
}

bool look_alike(const EffectKind& a, const EffectKind& b) {
  const auto lists = [](const EffectKind& x, const EffectKind& y) {
    return std::find(x.look_alikes.begin(), x.look_alikes.end(), y.name) != x.look_alikes.end();
  };
  return (is_timing(a.name) && is_timing(b.name)) || lists(a, b) || lists(b, a);
}

double threshold_of(const std::string& effect, const SelectionRules& rules) {
  return is_between_records(effect) ? rules.between_gain : rules.first_gain;
}

void add_columns(std::vector<int>& to, const std::vector<int>& columns) {
  for (int j : columns)
    if (std::find(to.begin(), to.end(), j) == to.end()) to.push_back(j);
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
  chosen.columns = channel.variants[static_cast<std::size_t>(family.best.variant)].columns;
  chosen.gain = family.gain;
  chosen.fall = family.best.fall;
  chosen.excess = excess_mean_square(channel, base);
  chosen.effect_rms = family.best.effect_rms;
  chosen.fit = family.best.fit;
  chosen.left_out = cross_fit(channel, base, family.best.fit);
  chosen.between = is_between_records(family.kind->name);
  chosen.records = family.records;
  if (chosen.between) {
    RecordTest test = test_records(input, channel, base, family, rules);
    chosen.not_by_records = std::move(test.objection);
    chosen.chance = test.chance;
  }
  chosen.strength_scatter = strength_scatter(channel.problem, family.best.fit, chosen.columns);
  return chosen;
}

Selection select_effects(const CampaignInput& input, ResidualChannel& channel, const std::vector<int>& always, const std::vector<std::string>& skip,
                         const SelectionRules& rules, unsigned threads) {
  Selection out;
  std::vector<int> present = always, carried = always;
  std::vector<std::string> taken = skip;
  ScreenResult result;
  std::size_t place = 0;  // in the ranking
  // what is carried along before anything is chosen belongs to the model that the first effect is judged against
  const auto screen_again = [&](const MixedFit* warm) {
    result = screen(channel, present, taken, warm, threads);
    place = 0;
    if (!result.base.valid) return false;
    judge_between_records(input, channel, present, result);
    out.final = result.base;
    out.excess_after = excess_mean_square(channel, result.base);
    if (out.chosen.empty()) {
      out.first = result;
      out.base = result.base;
      out.excess_before = out.excess_after;
    }
    return true;
  };
  if (!screen_again(nullptr)) return out;

  int latencies = 0;
  bool leads = false;  // of the output over the reference, carried along: what is late beside them repairs the reference's smoothing
  double largest_removed = 0.0;  // RMS
  constexpr std::size_t kMostPlaces = 4;
  for (int step = 0; step < rules.most; ++step) {
    if (result.families.empty()) break;
    if (place == 0) refine_leaders(input, channel, present, result, threads);
    if (out.chosen.empty()) out.first = result;
    const FamilyScore& family = result.families[place];
    const Variant& variant = channel.variants[static_cast<std::size_t>(family.best.variant)];
    ChosenEffect chosen = as_chosen(input, channel, result.base, family, rules);
    const bool first = out.chosen.empty();
    // a lead of the output may be the lag of the reference, unless it depends on the load
    const bool a_lead = rules.clock_slack && family.kind->name == "piezocapacitance" && family.gain > 4.0;
    const bool loaded_lead = a_lead && depends_on_load(channel, present, result.base, family);
    const bool plain_lead = a_lead && !loaded_lead;
    if (plain_lead && latencies == 0) {
      for (std::vector<int>* columns : {&present, &carried}) add_leads(channel, *columns, 0.006);
      out.nuisance.push_back("a lead of the output of a few milliseconds is left to the reference");
      if (!screen_again(&family.best.fit)) break;
      ++latencies;
      --step;
      continue;
    }
    const bool slight_shift = !a_lead && rules.clock_slack && is_timing(family.kind->name) && family.gain > 4.0 && !family.best.wrong_sign &&
                              shift_s(channel, family) <= kAllowedLatency_s && chosen.fall < (!first ? 0.6 : latencies > 0 ? 0.4 : 0.25);
    // what a late reference explains nearly as well is its own, whatever else may fit
    const bool nearly_latency = !loaded_lead && rules.clock_slack && latencies == 0 && first && place == 0 && is_nearly_latency(channel, result);
    if ((rules.clock_slack && is_reference_latency(channel, family) && family.gain > 4.0) || slight_shift || nearly_latency) {
      for (std::vector<int>* columns : {&present, &carried})
        if (slight_shift) columns->insert(columns->end(), variant.columns.begin(), variant.columns.end());
        else add_leads(channel, *columns);
      out.nuisance.push_back(slight_shift ? "output and reference are out of step by a few milliseconds, within what two clocks may be"
                                          : kLatencyNote);
      leads = leads || !slight_shift;
      if (!screen_again(&family.best.fit) || ++latencies > 2) break;
      --step;
      continue;
    }
    const std::string why = plain_lead || (leads && is_late(family.kind->name)) ? kLeads
                            : objection(channel, result, family, chosen, out.chosen, largest_removed, rules);
    if (!why.empty()) {
      out.refused.push_back({family.kind->name, why, family.gain, is_suspicion(why)});
      // the scatter within records and the spread between them are different questions: the next family may answer the
      // other. What fits worse than a refused family answers the same question no better
      const bool unphysical = family.best.wrong_sign || family.gain < rules.first_gain || why == kTooSmall || why == kJitter;
      ++place;
      while (!unphysical && place < result.families.size() && is_between_records(result.families[place].kind->name) == chosen.between) ++place;
      const bool other_question = place < result.families.size() && is_between_records(result.families[place].kind->name) && !chosen.between;
      if ((first || other_question) && place < result.families.size() && (!unphysical || place < kMostPlaces)) {
        --step;
        continue;
      }
      break;
    }
    set_shares(channel, result, place, rules, chosen);
    if (!chosen.between)
      largest_removed = std::max(largest_removed, std::sqrt(std::max(1e-18, chosen.fall * excess_mean_square(channel, result.base))));
    out.chosen.push_back(chosen);
    taken.push_back(family.kind->name);
    for (int j : variant.columns) present.push_back(j);
    add_columns(present, family_columns(channel, *family.kind));
    if (!screen_again(&family.best.fit)) break;
  }

  std::vector<std::string> not_asked = skip;
  if (leads) not_asked.insert(not_asked.end(), {"delay", "lag"});
  reconsider(input, channel, carried, not_asked, rules, threads, out);
  drop_needless(channel, carried, rules, out);
  fit_claimed(channel, out);
  // what is reported comes from the fit records alone
  const auto report = [&](MixedFit& fit) {
    const MixedFit refitted = fit_mixed(channel.problem, fit.columns, &fit, 8);
    if (refitted.valid) fit = refitted;
  };
  report(out.base);
  report(out.final);
  report(out.claimed);
  for (ChosenEffect& chosen : out.chosen) report(chosen.fit);
  return out;
}

}  // namespace forcegate::diagnose
