#include "hil/diagnose/choose/forward_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/between/mounting_places.h"
#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/partner.h"
#include "hil/diagnose/choose/probability.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/shares.h"

namespace forcegate::diagnose {

namespace {

bool helps_nothing_left_out(Refusal why) { return why == Refusal::helps_no_records || why == Refusal::helps_no_parts; }

class ForwardChoice {
 public:
  ForwardChoice(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                const SelectionRules& rules, unsigned threads)
      : input_(input), channel_(channel), rules_(rules), threads_(threads), allowed_latency_s_(allowed_latency_s(input)),
        reference_latency_s_(reference_latency_s(input)), base_(given.base), carried_(given.base), taken_(skip) {
    add_columns(carried_, given.soaking);
    present_ = carried_;
  }

  void run() {
    if (!screen_again(nullptr)) return;
    search();
    if (out_.chosen.empty()) search_all_forms();
    if (out_.chosen.empty()) search_simpler_forms();
  }

  ForwardChosen chosen() && { return {std::move(out_), std::move(carried_), leads_}; }

 private:
  // Nothing was taken so far; where nothing is again, the ranking stays that of before.
  void search_anew(Forms forms) {
    const ScreenResult before = out_.first;
    forms_ = forms;
    if (screen_again(nullptr)) search();
    if (out_.chosen.empty()) out_.first = before;
  }

  void search_all_forms() {
    if (std::ranges::any_of(channel_.candidates, [](const Candidate& c) { return c.form->last; })) search_anew(Forms::all);
  }

  // The last resort: another form, however well the best one fits.
  void search_simpler_forms() {
    if (std::ranges::none_of(out_.refused, [](const RefusedEffect& r) { return helps_nothing_left_out(r.reason); })) return;
    std::vector<RefusedEffect> refused = std::exchange(out_.refused, {});
    may_be_simpler_ = true;
    search_anew(Forms::ordinary);
    if (out_.chosen.empty()) out_.refused = std::move(refused);
  }

  void search() {
    while (static_cast<int>(out_.chosen.size()) < rules_.most && !result_.families.empty()) {
      if (place_ == 0) {
        refine_leaders(input_, channel_, present_, result_, threads_);
        put_expected_first();
      }
      if (out_.chosen.empty()) out_.first = result_;
      const FamilyScore& family = result_.families[place_];
      ChosenEffect chosen = as_chosen(input_, channel_, result_.base, family, rules_);
      const Lead lead = lead_of(family);
      if (const Clocks clocks = left_to_clocks(family, chosen, lead); clocks != Clocks::no) {
        if (!carry_along(family, clocks)) return;
        continue;
      }
      const auto [why, stands_out] = speaks_against(family, chosen, lead);
      chosen.stands_out = stands_out;
      if (why == Refusal::differs && agrees_beside_leads(family, chosen)) {
        if (!carry_along(family, Clocks::late_reference)) return;
        continue;
      }
      if (why == Refusal::leads && lead.plain() && shift_s(channel_, family) > longest_lead_s()) tell_lead(shift_s(channel_, family));
      if (may_be_simpler_ && helps_nothing_left_out(why))
        if (std::optional<Borne> other = borne_out_in_another_form(family, lead)) {
          if (!take(result_.families[place_] = other->family, other->chosen)) return;
          continue;
        }
      if (may_hide_another(why, chosen))
        if (std::optional<Partner> partner = partner_of(input_, channel_, present_, taken_, result_, family, rules_, threads_)) {
          result_ = std::move(partner->beside);
          place_ = partner->place;
          if (!take(result_.families[place_], partner->chosen)) return;
          continue;
        }
      if (!(why == Refusal::none ? take(family, chosen) : turn_down(family, why))) return;
      if (forms_ == Forms::all && !out_.chosen.empty()) return;
    }
  }

  // Of the output over the reference: it may be the lag of the reference, unless it depends on the load.
  struct Lead {
    bool is = false, loaded = false;
    bool plain() const { return is && !loaded; }
  };
  // What two clocks and a late reference may do, and what is not a finding therefore.
  enum class Clocks { no, lead, slight_shift, late_reference };
  static constexpr double kWorthCarrying = 4.0;  // nats
  static constexpr int kIterations = 9;

  // What is carried along before anything is chosen belongs to the model that the first effect is judged against.
  bool screen_again(const MixedFit* warm) {
    result_ = screen(channel_, present_, taken_, warm, threads_, kIterations, RecordUse::all_records, forms_);
    place_ = 0;
    if (!result_.base.valid) return false;
    refine_films(input_, channel_, present_, result_, threads_);
    if (std::ranges::find(taken_, "mounting") == taken_.end()) place_mountings(input_, channel_, result_.base, threads_);
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

  // What fits nearly as well as an effect that every such sensor has is that one.
  void put_expected_first() {
    std::vector<FamilyScore>& families = result_.families;
    const auto expected = std::ranges::find_if(families, [&](const FamilyScore& f) { return f.kind->name == rules_.expected; });
    if (expected == families.end() || expected == families.begin() || expected->best.wrong_sign || asks_between_records(families.front())) return;
    const double behind = (families.front().gain - expected->gain) / nats_of_a_factor(families.front().gain);
    if (behind < log_prior(*expected->kind, rules_)) std::rotate(families.begin(), expected, expected + 1);
  }

  Lead lead_of(const FamilyScore& family) const {
    Lead out;
    out.is = rules_.clock_slack && family.kind->name == "piezocapacitance" && family.gain > kWorthCarrying;
    out.loaded = out.is && depends_on_load(channel_, present_, result_.base, family);
    return out;
  }

  double longest_lead_s() const { return std::max(allowed_latency_s_, reference_latency_s_); }

  Clocks left_to_clocks(const FamilyScore& family, const ChosenEffect& chosen, const Lead& lead) const {
    if (!rules_.clock_slack) return Clocks::no;
    if (lead.plain() && latencies_ == 0 && shift_s(channel_, family) <= longest_lead_s()) return Clocks::lead;
    const bool first = out_.chosen.empty(), worth = family.gain > kWorthCarrying;
    const double least_fall = !first ? 0.6 : latencies_ > 0 ? 0.4 : 0.25;
    if (!lead.is && family.kind->traits.timing && worth && !family.best.wrong_sign && shift_s(channel_, family) <= allowed_latency_s_ &&
        chosen.fall < least_fall)
      return Clocks::slight_shift;
    // what a late reference explains nearly as well is its own, whatever else may fit
    const bool nearly = !lead.loaded && latencies_ == 0 && first && place_ == 0 && is_nearly_latency(channel_, result_, reference_latency_s_);
    return nearly || (worth && is_reference_latency(channel_, family, reference_latency_s_)) ? Clocks::late_reference : Clocks::no;
  }

  Objection speaks_against(const FamilyScore& family, const ChosenEffect& chosen, const Lead& lead) const {
    if (lead.plain() || (leads_ && family.kind->traits.late)) return {Refusal::leads};
    if (only_repairs_smoothing(family) && !lead.loaded) return {Refusal::in_step};
    return objection(channel_, result_, family, chosen, out_.chosen, largest_removed_, rules_);
  }

  // A family by another of its forms.
  struct Borne {
    FamilyScore family;
    ChosenEffect chosen;
  };

  // A form of many strengths follows what it is fitted to in more places than it foretells: left-out records may bear out a simpler one that fits less.
  std::optional<Borne> borne_out_in_another_form(const FamilyScore& family, const Lead& lead) const {
    if (asks_between_records(family)) return std::nullopt;
    for (const int variant : family.of_other_forms) {
      Borne out{family, {}};
      out.family.best = score_variant(channel_, present_, result_.base, variant, nullptr);
      out.family.gain += out.family.best.gain - family.best.gain;
      out.chosen = as_chosen(input_, channel_, result_.base, out.family, rules_);
      const Objection objection = speaks_against(out.family, out.chosen, lead);
      if (objection.why != Refusal::none) continue;
      out.chosen.stands_out = objection.stands_out;
      return out;
    }
    return std::nullopt;
  }

  // The first of all, of whose strength the records, or parts of them, say different things.
  bool may_hide_another(Refusal why, const ChosenEffect& chosen) const {
    return (why == Refusal::leaves_most || why == Refusal::differs || helps_nothing_left_out(why)) && out_.chosen.empty() && place_ == 0 && !chosen.between &&
           !rules_.forms_are_rough;
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
    return both.fit.valid && !both.wrong_sign && both.gain > rules_.first_gain && lead_s > 0.0 && lead_s <= reference_latency_s_ &&
           both.fit.log_evidence > family.best.fit.log_evidence + kWorthCarrying &&
           strength_scatter(channel_.problem, both.fit, chosen.columns) < kTighter * chosen.strength_scatter;
  }

  // A shift there and, beside it, one back again: their difference is the bend of the force, which smoothing has flattened.
  bool only_repairs_smoothing(const FamilyScore& family) const {
    return latencies_ > 0 && family.kind->traits.shift != TimeShift::none &&
           std::abs(net_shift_s(channel_, family.best.fit)) <= allowed_latency_s_;
  }

  void tell_lead(double lead_s) {
    leads_far_ = true;
    const std::string text = fmt::format("the output leads the reference by about {:.2g} ms: the reference, or a filter behind it, is late by more than is usual, "
                                         "or the sensor answers to the rate", 1e3 * lead_s);
    if (std::ranges::find(out_.nuisance, text) == out_.nuisance.end()) out_.nuisance.push_back(text);
  }

  // Without the effect that they were judged beside, leads may take its part, and predict nonsense: the error before it is one without them.
  bool allows_leads_alone() const {
    std::vector<int> columns = base_;
    add_leads(channel_, columns);
    const MixedFit leads = fit_mixed(channel_.problem, columns, &out_.base, 20);
    return leads.valid && -net_shift_s(channel_, leads) <= reference_latency_s_;
  }

  bool carry_along(const FamilyScore& family, Clocks clocks) {
    constexpr double kLead_s = 0.006;
    constexpr int kMostLatencies = 2;
    for (std::vector<int>* columns : {&present_, &carried_, &base_}) {
      if (columns == &base_ && clocks == Clocks::late_reference && !allows_leads_alone()) continue;
      const std::vector<int>& own = columns_of(channel_, family.best.variant);
      if (clocks == Clocks::slight_shift) columns->insert(columns->end(), own.begin(), own.end());
      else if (clocks == Clocks::lead) add_leads(channel_, *columns, kLead_s);
      else add_leads(channel_, *columns);
    }
    if (!leads_far_)
      out_.nuisance.push_back(clocks == Clocks::lead ? "a lead of the output of a few milliseconds is left to the reference"
                            : clocks == Clocks::slight_shift
                                ? "output and reference are out of step by a few milliseconds, within what two clocks may be"
                                : latency_note(input_));
    leads_ = leads_ || clocks == Clocks::late_reference;
    return screen_again(&family.best.fit) && ++latencies_ <= kMostLatencies;
  }

  // The scatter within records and the spread between them are different questions: the next family may answer the other. What fits worse
  // than a refused family answers the same question no better; yet evidence from strengths that records do not share, left-out ones or any, is no fit,
  // nor is that of codes which explain too little.
  bool turn_down(const FamilyScore& family, Refusal why) {
    constexpr std::size_t kMostPlaces = 4;
    out_.refused.push_back({family.kind->name, why, family.gain});
    const bool unphysical = family.best.wrong_sign || family.gain < rules_.first_gain || why == Refusal::too_small || why == Refusal::jitter;
    const auto& families = result_.families;
    const bool between = asks_between_records(family);
    const bool is_no_fit = why == Refusal::helps_no_records || why == Refusal::differs || why == Refusal::few_jumps;
    const auto fits_worse = [&](const FamilyScore& next) {
      // a cause that nobody recorded may fit better and stand behind by its prior
      return asks_between_records(next) == between && !(is_no_fit && next.best.fall > family.best.fall) && !(between && next.gain > family.gain);
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
    if (const double lead_s = rival_lead_s(channel_, result_, family); rules_.clock_slack && lead_s > longest_lead_s()) tell_lead(lead_s);
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
  double allowed_latency_s_, reference_latency_s_;
  std::vector<int> base_, carried_, present_;  // of the model; with what its families soak up; with what was chosen too
  std::vector<std::string> taken_;
  Forms forms_ = Forms::ordinary;
  bool may_be_simpler_ = false;
  ScreenResult result_;
  std::size_t place_ = 0;  // in the ranking
  int latencies_ = 0;
  bool leads_ = false;  // carried along: what is late beside them repairs the reference's smoothing
  bool leads_far_ = false;  // by more than clocks and references do, and told
  double largest_removed_ = 0.0;  // RMS
  Selection out_;
};

}  // namespace

ForwardChosen choose_forward(const CampaignInput& input, ResidualChannel& channel, const Given& given, const std::vector<std::string>& skip,
                             const SelectionRules& rules, unsigned threads) {
  ForwardChoice forward(input, channel, given, skip, rules, threads);
  forward.run();
  return std::move(forward).chosen();
}

}  // namespace forcegate::diagnose
