#include "hil/diagnose/choose/outdone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/spare_room.h"
#include "hil/diagnose/candidates/unnamed_dependences.h"
#include "hil/diagnose/choose/refine.h"

namespace forcegate::diagnose {

namespace {

MixedFit fit_all(const ResidualChannel& channel, const std::vector<int>& columns, const MixedFit& warm) {
  return fit_mixed(channel.problem, columns, &warm, 12, RecordUse::all_records);
}

FamilyScore best_of(const CampaignInput& input, ResidualChannel& channel, const EffectKind& kind, const std::vector<int>& present, const MixedFit& base,
                    double to_beat, unsigned threads, std::vector<double>& best_shape) {
  constexpr double kWorthMoving = 0.4, kLeast = 10.0;
  FamilyScore out;
  out.kind = &kind;
  out.best.gain = -1e300;
  const EffectForm& form = kind.forms.front();
  const int candidate = place_candidate(channel, {&kind, &form, {}, 0, static_cast<int>(form.strength.size())});
  std::vector<int> columns(form.strength.size());
  std::iota(columns.begin(), columns.end(), channel.candidates.back().first);
  channel.variants.push_back({candidate, columns});
  const int variant = static_cast<int>(channel.variants.size()) - 1;
  for (const std::vector<double>& shape : form.grid(input)) {
    channel.candidates.back().shape = shape;
    fill_candidate(input, channel, channel.candidates.back(), threads, &present);
    VariantScore score = score_variant(channel, present, base, variant, nullptr, 12);
    if (!(score.gain > out.best.gain)) continue;
    out.best = std::move(score);
    best_shape = shape;
  }
  if (!out.best.fit.valid) return out;
  channel.candidates.back().shape = best_shape;
  if (out.best.gain > std::max(kLeast, kWorthMoving * to_beat) && refine_family(input, channel, present, base, out, threads))
    best_shape = channel.candidates.back().shape;
  return out;
}

struct Place {
  std::vector<std::string> effects;
  std::vector<int> others;  ///< columns of the model without it
  MixedFit without;
  double gain = 0.0;
};

std::vector<Place> places_of(const ResidualChannel& channel, const Selection& selection, bool structured) {
  std::vector<Place> out;
  MixedFit claimed = fit_all(channel, selection.claimed.columns, selection.claimed);
  if (!claimed.valid) return out;
  for (const ChosenEffect& chosen : selection.chosen) {
    if (chosen.between) continue;
    Place place{{chosen.kind->name}, selection.base.columns, {}};
    for (const ChosenEffect& other : selection.chosen)
      if (&other != &chosen) add_columns(place.others, columns_of(channel, other));
    place.without = fit_all(channel, place.others, claimed);
    if (!place.without.valid) continue;
    place.gain = claimed.log_evidence - place.without.log_evidence;
    out.push_back(std::move(place));
  }
  if (out.size() > 1) {
    Place all{{}, selection.base.columns, {}};
    for (const Place& one : out) all.effects.push_back(one.effects.front());
    for (const ChosenEffect& other : selection.chosen)
      if (other.between) add_columns(all.others, columns_of(channel, other));
    all.without = fit_all(channel, all.others, claimed);
    all.gain = claimed.log_evidence - all.without.log_evidence;
    if (all.without.valid) out.push_back(std::move(all));
  }
  if (structured) out.push_back({{}, claimed.columns, std::move(claimed)});
  return out;
}

// Forms differ: a name keeps its place against what fits a little better. What is left has no name to be outdone: most of it must go.
constexpr double kMore = 20.0;

// Beside what is blind to the load: within this they explain the same.
double tie_of(const Place& place) {
  constexpr double kForms = 0.02;
  return kMore + kForms * std::max(0.0, place.gain);
}

bool fills(const Place& place, const VariantScore& score, const UnnamedDependence& by) {
  constexpr double kTimes = 1.15, kMost = 0.5;
  const double least = by.is_simpler ? std::max(kMore, place.gain) : by.is_blind ? place.gain + tie_of(place) : kTimes * std::max(0.0, place.gain) + kMore;
  return score.gain > least && (!place.effects.empty() || score.fall > kMost);
}

bool ties(const Place& place, const VariantScore& score, const UnnamedDependence& by) {
  return by.is_blind && place.effects.size() == 1 && std::abs(score.gain - place.gain) <= tie_of(place);
}

}  // namespace

std::vector<Outdone> outdone_by_unnamed(const CampaignInput& input, ResidualChannel& channel, const Selection& selection, bool structured,
                                        unsigned threads) {
  std::vector<Outdone> out;
  const std::vector<UnnamedDependence> unnamed = unnamed_dependences(input);
  for (const Place& place : places_of(channel, selection, structured)) {
    const bool of_time = !place.effects.empty() && is_timing(place.effects.front()), several = place.effects.size() > 1;
    Outdone best{place.effects, {}, {}, place.gain, 0.0}, tie;
    std::vector<double> shape;
    for (const UnnamedDependence& dependence : unnamed) {
      if ((dependence.is_late && !place.effects.empty() && !of_time) || (several && !dependence.is_simpler && !dependence.is_blind)) continue;
      const SpareRoom room(channel);
      const FamilyScore score = best_of(input, channel, dependence.kind, place.others, place.without, place.gain, threads, shape);
      if (ties(place, score.best, dependence)) tie = {place.effects, dependence.kind.summary, dependence.group, place.gain, score.best.gain, true};
      if (!fills(place, score.best, dependence) || score.best.gain <= best.by_gain) continue;
      best.by = dependence.kind.summary;
      if (dependence.tells_when) best.by += fmt::format(", after about {:.3g} s", shape.front() * input.records.front().t_s.back());
      best.group = dependence.group;
      best.by_gain = score.best.gain;
    }
    if (best.by.empty()) best = std::move(tie);
    if (!best.by.empty()) out.push_back(std::move(best));
  }
  return out;
}

void withdraw_outdone(const std::vector<Outdone>& outdone, Diagnosis& out) {
  constexpr double kTied = 0.7;
  for (const Outdone& o : outdone) {
    if (o.is_tie) {
      const std::string& name = o.effects.front();
      const auto found = std::ranges::find_if(out.findings, [&](const Finding& f) { return f.effect == name && f.claimed() && !f.between_records; });
      if (found == out.findings.end()) continue;
      found->limit(kTied, o.by + ", whatever the load, explains as much of it");
      out.notes.push_back(fmt::format("{} and {}, whatever the load, look the same under this load (log evidence {:.0f} and {:.0f}): a rest without load on the way, "
                                      "and other loads after it, tell them apart",
                                      name, o.by, o.gain, o.by_gain));
      continue;
    }
    const bool several = o.effects.size() > 1;
    for (Finding& f : out.findings)
      if (!f.of_samples() && (std::ranges::find(o.effects, f.effect) != o.effects.end() || (several && f.of_output() && !f.between_records)))
        f.limit(kWithdrawn, o.by + " explains more of it");
    char text[240];
    if (o.effects.empty()) std::snprintf(text, sizeof text, "no effect of the library: what is left follows %s (log evidence %.0f)", o.by.c_str(), o.by_gain);
    else
      std::snprintf(text, sizeof text, "no effect of the library: the output follows %s (log evidence %.0f, against %.0f of %s)", o.by.c_str(), o.by_gain,
                    o.gain, several ? "all of them" : o.effects.front().c_str());
    out.notes.emplace_back(text);
  }
}

}  // namespace forcegate::diagnose
