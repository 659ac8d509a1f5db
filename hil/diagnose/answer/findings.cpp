#include "hil/diagnose/answer/findings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/found_parameters.h"
#include "hil/diagnose/answer/reservation.h"
#include "hil/diagnose/between/foretold.h"
#include "hil/diagnose/choose/in_place.h"
#include "hil/diagnose/choose/objection.h"
#include "hil/diagnose/choose/probability.h"
#include "hil/diagnose/choose/refit_chosen.h"
#include "hil/model/lagged_channel.h"

namespace forcegate::diagnose {

namespace {

// The summary tells of the sign that the sensors of the library have.
std::string the_other_way_round(const ChosenEffect& chosen, const ResidualChannel& channel, const Finding& f) {
  const bool one_sign = candidate_of(channel, chosen.variant).form->sign == StrengthSign::positive;
  if (!one_sign || f.parameters.empty() || !(f.parameters.front().value < -f.parameters.front().u)) return "";
  return "; here the other way round, " + f.parameters.front().name + " is negative";
}

// `single`: one recording, its records are parts of it.
std::string sentence(const ChosenEffect& chosen, const ResidualChannel& channel, JudgedBy by, bool single, const Finding& f) {
  char text[480];
  const PrintedUnit unit = printed_unit(channel.unit);
  const char* judges = by == JudgedBy::whole ? "the whole recording" : single ? "parts left out" : f.of_every_record ? "every record, predicted from all others," : "records left out";
  if (f.error_after < f.error_before)
    std::snprintf(text, sizeof text, "it accounts for %s %s RMS (%.2g %% of the span): the error of %s falls from %s to %s %s",
                  plain_number(f.effect_rms * unit.factor).c_str(), unit.name.c_str(), 100.0 * f.effect_rms / channel.scale, judges,
                  plain_number(f.error_before * unit.factor).c_str(), plain_number(f.error_after * unit.factor).c_str(), unit.name.c_str());
  else
    std::snprintf(text, sizeof text, "the error of %s hardly shows it: %s %s without and %s %s with it", judges,
                  plain_number(f.error_before * unit.factor).c_str(), unit.name.c_str(), plain_number(f.error_after * unit.factor).c_str(), unit.name.c_str());
  std::string out = chosen.kind->summary + the_other_way_round(chosen, channel, f) + "; " + text;
  if (chosen.records.same_strength) out += "; the levels of the records tell the strength that the rows within them tell";
  if (chosen.by_records()) {
    // the decay differs from record to record too: the error of whole records says little of a gain
    std::snprintf(text, sizeof text,
                  "%s; it accounts for %.3g %s RMS (%.2g %% of the span) and for %.0f %% of the scatter that it acts on; where a record is "
                  "predicted from the others, the mean square error of that falls by %.0f %%",
                  chosen.kind->summary.c_str(), f.effect_rms * unit.factor, unit.name.c_str(), 100.0 * f.effect_rms / channel.scale,
                  100.0 * chosen.records.explained, 100.0 * (1.0 - chosen.records.left_out));
    out = text;
    if (f.error_after < f.error_before)
      out += fmt::format("; with one gain and zero for all, the error of {} falls from {} to {} {}",
                         f.of_every_record ? "every record, predicted from all others," : "records left out",
                         plain_number(f.error_before * unit.factor), plain_number(f.error_after * unit.factor), unit.name);
    if (chosen.records.same_strength) out += "; the rows within the records tell the same strength";
    return out;
  }
  if (by != JudgedBy::whole && f.records_excited > 0) {
    std::snprintf(text, sizeof text,
                  "; %d of %d %s that it touches improve, its strength differs by %.0f %% between %s",
                  f.records_improved, f.records_excited,
                  single ? "parts of the recording" : f.counts_parts ? "parts of records" : "records", 100.0 * chosen.strength_scatter,
                  single ? "them" : "records");
    out += text;
  }
  if (chosen.seen_in_place) out += fmt::format("; {}", what_shows_in_place(*chosen.kind));
  return out;
}

// Of what was chosen and is no claim, where no rule has said it.
std::string why_no_claim(const Workspace& w, const ResidualChannel& channel, const ChosenEffect& chosen, double real, double whole) {
  const Candidate& c = candidate_of(channel, chosen.variant);
  if (chosen.between && real < kClaim && c.form->name == kUnrecorded) return std::string(row_of(Cap::unrecorded).why);
  if (chosen.between && real < kClaim)
    return fmt::format("{} records say little of what acts between them, and chance alone leaves odds of {:.2g} to 1 against it", w.input.records.size(), (1.0 - real) / real);
  if (real * chosen.share_of_family < kClaim)
    return std::ranges::any_of(chosen.rivals, [&](const auto& rival) { return rival.second > chosen.share_of_family; }) ? "others fit better and take most of the probability"
                                                                                                                      : "others fit nearly as well and share the probability";
  return whole < 1.0 ? "what was found leaves most of what the noise does not explain" : "";
}

// Two effects that hide each other help fewer records alone than beside each other: where the count is not of all, it is asked against the model
// that lacks this one only.
CrossFit records_that_it_helps(const ResidualChannel& channel, const Selection& selection, const ChosenEffect& chosen) {
  const CrossFit& entered = chosen.left_out;
  if (chosen.between || selection.chosen.size() < 2 || entered.improved == entered.excited || !selection.claimed.valid) return entered;
  const MixedFit without = fit_mixed(channel.problem, columns_beside(channel, selection, chosen), &selection.claimed, 12, selection.claimed.use);
  if (!without.valid) return entered;
  const CrossFit beside = cross_fit(channel, without, selection.claimed);
  return beside.improved * entered.excited > entered.improved * beside.excited ? beside : entered;
}

// Share of what the noise does not explain that an effect takes, of what the chosen ones take within records. One between them moves levels, which
// every record has of its own there: it is asked for the error of one gain and zero for all.
double share_explained(const ResidualChannel& channel, const ChosenEffect& chosen, double within_records) {
  if (!chosen.by_records()) return within_records;
  const auto square = [](double x) { return x * x; };
  const double before = square(chosen.error_before), allowed = square(allowed_rms(channel) * channel.scale);
  return before > allowed ? std::max(within_records, (before - square(chosen.error_after)) / (before - allowed)) : within_records;
}

}  // namespace

void add_findings(const Workspace& w, const ResidualChannel& channel, const Selection& selection,
                  double explained, Diagnosis& out) {
  for (const ChosenEffect& chosen : selection.chosen) {
    Finding f = finding_about(*chosen.kind, channel);
    const double real = probability_that_real(w.input, channel, chosen);
    const double of_error = share_explained(channel, chosen, explained), whole = of_error > 0.5 ? 1.0 : 0.45 + of_error;
    f.probability = std::max(0.0, real * whole * chosen.share_of_family);
    f.form = candidate_of(channel, chosen.variant).form->name;
    f.parameters = found_parameters(w.input, channel, chosen, &channel == &w.output ? chosen.fit.coefficient[0] * channel.gain_of_unit : 1.0);
    f.between_records = chosen.between;
    f.error_before = chosen.error_before;
    f.error_after = chosen.error_after;
    f.of_every_record = chosen.of_every_record && w.judges == JudgedBy::heldout;
    f.effect_rms = chosen.by_records() || chosen.records.same_strength ? effect_rms_between(channel, chosen.fit, chosen.columns) * channel.scale
                                       : std::sqrt(std::max(0.0, f.error_before * f.error_before - f.error_after * f.error_after));
    const CrossFit helped = records_that_it_helps(channel, selection, chosen);
    f.records_improved = helped.improved;
    f.records_excited = helped.excited;
    f.counts_parts = helped.blocks;
    f.evidence = sentence(chosen, channel, w.judges, w.input.single, f);
    if (!chosen.borne_out) f.limit(kNoClaim, kDoesNotFall);
    reserve(w, channel, selection.base, f);
    if (!f.claimed() && f.reservations.empty())
      if (const std::string why = why_no_claim(w, channel, chosen, real, whole); !why.empty()) f.not_claimed(why);
    for (const FamilyScore& rival : selection.first.families) {
      if (rival.kind == chosen.kind || rival.gain < 3.0) continue;
      const double cosine =
          signature_cosine(channel, selection.base, chosen.fit, chosen.columns, rival.best.fit,
                           columns_of(channel, rival.best.variant));
      if (std::abs(cosine) > 0.9)
        f.confounded_with.push_back({rival.kind->name, cosine, chosen.kind->separates});
    }
    for (const auto& [name, share] : chosen.rivals)
      if (share > 0.2 && std::none_of(f.confounded_with.begin(), f.confounded_with.end(),
                                      [&, n = name](const LookAlike& a) { return a.effect == n; }))
        f.confounded_with.push_back({name, 0.0, chosen.kind->separates});
    out.findings.push_back(std::move(f));
    // the rivals of this place stand beside it with what is left of the probability
    for (const auto& [name, share] : chosen.rivals) {
      const EffectKind* kind = kind_of(w, name);
      if (kind == nullptr || share < 0.05) continue;
      Finding weak = finding_about(*kind, channel);
      weak.rival_of = chosen.kind->name;
      weak.probability = std::clamp(share * real * whole, 0.0, kNoClaim);
      weak.evidence = (share > chosen.share_of_family ? "fits better than " : "fits nearly as well as ") + chosen.kind->name + "; " + kind->separates;
      out.findings.push_back(std::move(weak));
    }
  }
}

namespace {

void add_suspicion(const Workspace& w, const RefusedEffect& refused, double probability, Diagnosis& out) {
  const EffectKind* kind = kind_of(w, refused.effect);
  if (kind == nullptr) return;
  Finding f = kind->channel == EffectChannel::rig ? finding_about(*kind, "N", ShownIn::rig) : finding_about(*kind, w.output);
  f.probability = probability;
  f.evidence = kind->summary + "; not claimed: " + std::string(traits_of(refused.reason).sentence);
  const auto weaker = std::find_if(out.findings.begin(), out.findings.end(), [&](const Finding& o) { return o.probability < f.probability; });
  out.findings.insert(weaker, std::move(f));
}

// A handful of records says little of what acts between them: where nothing else is to be told, the likeliest cause is.
const RefusedEffect* likeliest_between_records(const std::vector<RefusedEffect>& refused, double enough) {
  constexpr double kWorthTelling = 1.0;  // nats
  const RefusedEffect* out = nullptr;
  for (const RefusedEffect& r : refused) {
    const bool little = r.reason == Refusal::too_little_evidence && r.score < enough,
               uncertain = r.reason == Refusal::records_scatter_on || r.reason == Refusal::helps_no_left_levels || r.reason == Refusal::any_order;
    if (is_between_records(r.effect) && (little || uncertain) && r.score >= kWorthTelling && (out == nullptr || r.score > out->score)) out = &r;
  }
  return out;
}

}  // namespace

void suspect_refused(const Workspace& w, const SelectionRules& rules, Diagnosis& out) {
  constexpr double kLeastScore = 20.0;
  constexpr double kBetweenRecords = 0.4;  // how often it was that one: counted on 50 of them from three generators
  const RefusedEffect* strongest = nullptr;
  const std::vector<RefusedEffect> refused = refused_beside_findings(out);
  for (const RefusedEffect& r : refused)
    if (r.score >= kLeastScore && (strongest == nullptr || r.score > strongest->score)) strongest = &r;
  const bool any_claim = std::ranges::any_of(out.findings, [](const Finding& o) { return o.claimed(); });
  if (strongest != nullptr) add_suspicion(w, *strongest, suspicion_probability(strongest->reason, any_claim), out);
  if (!out.findings.empty()) return;
  if (const RefusedEffect* between = likeliest_between_records(out.refused, rules.between_gain)) add_suspicion(w, *between, kBetweenRecords, out);
}

void share_among_timing(const Selection& selection, std::vector<Finding>& findings) {
  std::vector<const ChosenEffect*> timing;
  for (const ChosenEffect& c : selection.chosen)
    if (c.kind->traits.timing) timing.push_back(&c);
  if (timing.size() < 2) return;
  std::stable_sort(timing.begin(), timing.end(),
                   [](const ChosenEffect* a, const ChosenEffect* b) { return a->unique > b->unique; });
  double left = 1.0;
  for (const ChosenEffect* c : timing)
    for (Finding& f : findings)
      if (f.effect == c->kind->name && !f.of_samples()) {
        f.limit(std::max(0.0, left), "one residual has one cause in time");
        left -= f.probability;
      }
}

void tell_not_separable(const Selection& selection, Diagnosis& out) {
  constexpr double kOdds = 4.0;
  for (const ChosenEffect& c : selection.chosen) {
    std::vector<std::string> set = {c.kind->name};
    for (const auto& [name, share] : c.rivals)
      if (kOdds * share >= c.share_of_family) set.push_back(name);
    if (set.size() < 2) continue;
    const auto is_open = [&](const std::string& name) {
      const auto f = std::ranges::find(out.findings, name, &Finding::effect);
      return f != out.findings.end() && f->probability > kWithdrawn;
    };
    if (std::ranges::none_of(set, is_open)) continue;
    std::string text = "not separable here: " + set[0];
    for (std::size_t k = 1; k < set.size(); ++k) text += " or " + set[k];
    out.notes.push_back(text + "; what parts them: " + c.kind->separates);
    out.not_separable.push_back(std::move(set));
  }
}

}  // namespace forcegate::diagnose
