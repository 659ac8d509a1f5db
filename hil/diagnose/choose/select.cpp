#include "hil/diagnose/choose/select.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/left_out.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/choose/further_forms.h"
#include "hil/diagnose/choose/needless.h"
#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/reconsider.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/refit_chosen.h"
#include "hil/diagnose/choose/shares.h"

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

}  // namespace

std::vector<int> columns_of(const ResidualChannel& channel, const ChosenEffect& effect) {
  std::vector<int> out = effect.columns;
  for (const int further : effect.further) add_columns(out, channel.variants[static_cast<std::size_t>(further)].columns);
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

bool is_between_records(const std::string& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  return kind != nullptr && kind->traits.between_records;
}

bool look_alike(const EffectKind& a, const EffectKind& b) {
  const auto lists = [](const EffectKind& x, const EffectKind& y) {
    return std::find(x.look_alikes.begin(), x.look_alikes.end(), y.name) != x.look_alikes.end();
  };
  return (a.traits.timing && b.traits.timing) || lists(a, b) || lists(b, a);
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
  chosen.between = family.kind->traits.between_records;
  chosen.describes_whole = rules.one_zero && !chosen.between && describes_whole(input, channel, base, family.best.fit);
  chosen.records = family.records;
  if (chosen.between) {
    const RecordTest test = test_records(input, channel, base, family, rules);
    chosen.not_by_records = test.objection;
    chosen.chance = test.chance;
  }
  chosen.strength_scatter = strength_scatter(channel.problem, family.best.fit, chosen.columns);
  return chosen;
}

namespace {

// Forward choice: one family after the other, each beside those that were taken.
class ForwardChoice {
 public:
  ForwardChoice(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                const SelectionRules& rules, unsigned threads)
      : input_(input), channel_(channel), rules_(rules), threads_(threads), allowed_latency_s_(allowed_latency_s(input)), base_(given.base), carried_(given.base), taken_(skip) {
    add_columns(carried_, given.soaking);
    present_ = carried_;
  }

  void run() {
    if (!screen_again(nullptr)) return;
    while (static_cast<int>(out_.chosen.size()) < rules_.most && !result_.families.empty()) {
      if (place_ == 0) refine_leaders(input_, channel_, present_, result_, threads_);
      if (out_.chosen.empty()) out_.first = result_;
      const FamilyScore& family = result_.families[place_];
      ChosenEffect chosen = as_chosen(input_, channel_, result_.base, family, rules_);
      const Lead lead = lead_of(family);
      if (const Clocks clocks = left_to_clocks(family, chosen, lead); clocks != Clocks::no) {
        if (!carry_along(family, clocks)) return;
        continue;
      }
      const Refusal why = lead.plain() || (leads_ && family.kind->traits.late)
                                  ? Refusal::leads
                              : only_repairs_smoothing(family) && !lead.loaded
                                  ? Refusal::in_step
                                  : objection(channel_, result_, family, chosen, out_.chosen, largest_removed_, rules_);
      if (why == Refusal::differs && agrees_beside_leads(family, chosen)) {
        if (!carry_along(family, Clocks::late_reference)) return;
        continue;
      }
      if (!(why == Refusal::none ? take(family, chosen) : turn_down(family, why))) return;
    }
  }

  Selection& selection() { return out_; }
  const std::vector<int>& carried() const { return carried_; }
  bool leads() const { return leads_; }

 private:
  // Of the output over the reference: it may be the lag of the reference, unless it depends on the load.
  struct Lead {
    bool is = false, loaded = false;
    bool plain() const { return is && !loaded; }
  };
  // What two clocks and a late reference may do, and what is not a finding therefore.
  enum class Clocks { no, lead, slight_shift, late_reference };
  static constexpr double kWorthCarrying = 4.0;  // nats

  // What is carried along before anything is chosen belongs to the model that the first effect is judged against.
  bool screen_again(const MixedFit* warm) {
    result_ = screen(channel_, present_, taken_, warm, threads_);
    place_ = 0;
    if (!result_.base.valid) return false;
    judge_between_records(input_, channel_, present_, rules_, result_);
    out_.final = result_.base;
    out_.excess_after = excess_mean_square(channel_, result_.base);
    if (out_.chosen.empty()) {
      out_.first = result_;
      out_.base = base_.size() == present_.size() ? result_.base : fit_to_the_end(channel_, base_, &result_.base, 18, RecordUse::all_records);
      out_.excess_before = excess_mean_square(channel_, out_.base);
      if (!out_.base.valid) return false;
    }
    return true;
  }

  Lead lead_of(const FamilyScore& family) const {
    Lead out;
    out.is = rules_.clock_slack && family.kind->name == "piezocapacitance" && family.gain > kWorthCarrying;
    out.loaded = out.is && depends_on_load(channel_, present_, result_.base, family);
    return out;
  }

  Clocks left_to_clocks(const FamilyScore& family, const ChosenEffect& chosen, const Lead& lead) const {
    if (!rules_.clock_slack) return Clocks::no;
    if (lead.plain() && latencies_ == 0) return Clocks::lead;
    const bool first = out_.chosen.empty(), worth = family.gain > kWorthCarrying;
    const double least_fall = !first ? 0.6 : latencies_ > 0 ? 0.4 : 0.25;
    if (!lead.is && family.kind->traits.timing && worth && !family.best.wrong_sign && shift_s(channel_, family) <= allowed_latency_s_ &&
        chosen.fall < least_fall)
      return Clocks::slight_shift;
    // what a late reference explains nearly as well is its own, whatever else may fit
    const bool nearly = !lead.loaded && latencies_ == 0 && first && place_ == 0 && is_nearly_latency(channel_, result_);
    return nearly || (worth && is_reference_latency(channel_, family)) ? Clocks::late_reference : Clocks::no;
  }

  // A wheel that turns at a constant speed loads as fast as it pushes sideways, and a late reference takes part of such an effect for its own,
  // more so the faster the record. What has one strength in all records beside the leads that a reference may have is judged beside them.
  bool agrees_beside_leads(const FamilyScore& family, const ChosenEffect& chosen) const {
    constexpr double kTighter = 0.5;  // of the scatter between records without them
    if (!rules_.clock_slack || latencies_ > 0 || family.kind->traits.timing) return false;
    std::vector<int> columns = present_;
    add_leads(channel_, columns);
    if (columns.size() == present_.size()) return false;
    const MixedFit leads = fit_mixed(channel_.problem, columns, &result_.base, 20, result_.base.use);
    if (!leads.valid) return false;
    const VariantScore both = score_variant(channel_, columns, leads, family.best.variant, nullptr);
    const double lead_s = -net_shift_s(channel_, both.fit);
    return both.fit.valid && !both.wrong_sign && both.gain > rules_.first_gain && lead_s > 0.0 && lead_s <= kAllowedLatency_s &&
           both.fit.log_evidence > family.best.fit.log_evidence + kWorthCarrying &&
           strength_scatter(channel_.problem, both.fit, chosen.columns) < kTighter * chosen.strength_scatter;
  }

  // A shift there and, beside it, one back again: their difference is the bend of the force, which smoothing has flattened.
  bool only_repairs_smoothing(const FamilyScore& family) const {
    return latencies_ > 0 && family.kind->traits.timing && family.kind->name != "clock_skew" &&
           std::abs(net_shift_s(channel_, family.best.fit)) <= allowed_latency_s_;
  }

  // Without the effect that they were judged beside, leads may take its part, and predict nonsense: the error before it is one without them.
  bool allows_leads_alone() const {
    std::vector<int> columns = base_;
    add_leads(channel_, columns);
    const MixedFit leads = fit_mixed(channel_.problem, columns, &out_.base, 20);
    return leads.valid && -net_shift_s(channel_, leads) <= kAllowedLatency_s;
  }

  bool carry_along(const FamilyScore& family, Clocks clocks) {
    constexpr double kLead_s = 0.006;
    constexpr int kMostLatencies = 2;
    for (std::vector<int>* columns : {&present_, &carried_, &base_}) {
      if (columns == &base_ && clocks == Clocks::late_reference && !allows_leads_alone()) continue;
      const std::vector<int>& own = channel_.variants[static_cast<std::size_t>(family.best.variant)].columns;
      if (clocks == Clocks::slight_shift) columns->insert(columns->end(), own.begin(), own.end());
      else if (clocks == Clocks::lead) add_leads(channel_, *columns, kLead_s);
      else add_leads(channel_, *columns);
    }
    out_.nuisance.push_back(clocks == Clocks::lead ? "a lead of the output of a few milliseconds is left to the reference"
                            : clocks == Clocks::slight_shift
                                ? "output and reference are out of step by a few milliseconds, within what two clocks may be"
                                : kLatencyNote);
    leads_ = leads_ || clocks == Clocks::late_reference;
    return screen_again(&family.best.fit) && ++latencies_ <= kMostLatencies;
  }

  // The scatter within records and the spread between them are different questions: the next family may answer the other. What fits worse
  // than a refused family answers the same question no better; yet evidence from strengths that left-out records do not share is no fit.
  bool turn_down(const FamilyScore& family, Refusal why) {
    constexpr std::size_t kMostPlaces = 4;
    out_.refused.push_back({family.kind->name, why, family.gain});
    const bool unphysical = family.best.wrong_sign || family.gain < rules_.first_gain || why == Refusal::too_small || why == Refusal::jitter;
    const auto& families = result_.families;
    const bool between = asks_between_records(family);
    const auto fits_worse = [&](const FamilyScore& next) {
      return asks_between_records(next) == between && (why != Refusal::helps_no_records || next.best.fall <= family.best.fall);
    };
    ++place_;
    // beside what was chosen only the other question is left, and so it is far down in the ranking
    const bool far_down = !out_.chosen.empty() || (unphysical && place_ >= kMostPlaces);
    const auto passed_over = [&](const FamilyScore& next) { return unphysical || far_down ? far_down && asks_between_records(next) == between : fits_worse(next); };
    while (place_ < families.size() && passed_over(families[place_])) ++place_;
    if (place_ >= families.size()) return false;
    const bool other_question = asks_between_records(families[place_]) && !between;
    return other_question || !far_down;
  }

  bool take(const FamilyScore& family, ChosenEffect& chosen) {
    set_shares(channel_, result_, place_, rules_, !out_.chosen.empty(), chosen);
    if (!chosen.between)
      largest_removed_ = std::max(largest_removed_, std::sqrt(std::max(1e-18, chosen.fall * excess_mean_square(channel_, result_.base))));
    out_.chosen.push_back(chosen);
    taken_.push_back(family.kind->name);
    add_columns(present_, chosen.columns);
    add_columns(present_, family_columns(channel_, *family.kind));
    return screen_again(&family.best.fit);
  }

  const CampaignInput& input_;
  ResidualChannel& channel_;
  const SelectionRules& rules_;
  unsigned threads_;
  double allowed_latency_s_;
  std::vector<int> base_, carried_, present_;  // of the model; with what its families soak up; with what was chosen too
  std::vector<std::string> taken_;
  ScreenResult result_;
  std::size_t place_ = 0;  // in the ranking
  int latencies_ = 0;
  bool leads_ = false;  // carried along: what is late beside them repairs the reference's smoothing
  double largest_removed_ = 0.0;  // RMS
  Selection out_;
};

}  // namespace

Selection select_effects(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                         const SelectionRules& rules, unsigned threads) {
  ForwardChoice forward(input, channel, given, skip, rules, threads);
  forward.run();
  Selection out = std::move(forward.selection());
  if (!out.base.valid) return out;

  std::vector<std::string> not_asked = skip;
  if (forward.leads()) not_asked.insert(not_asked.end(), {"delay", "lag"});
  reconsider(input, channel, forward.carried(), not_asked, rules, threads, out);
  if (rules.one_zero) find_what_completes_whole(input, channel, out);
  drop_needless(channel, forward.carried(), rules, out);
  out.carried = forward.carried();
  report_selection(channel, out);
  return out;
}

void leave_out(const ResidualChannel& channel, const std::function<bool(const ChosenEffect&)>& goes, Selection& selection) {
  if (std::erase_if(selection.chosen, goes) == 0) return;
  refit_chosen(channel, selection.carried, selection);
  report_selection(channel, selection);
}

}  // namespace forcegate::diagnose
