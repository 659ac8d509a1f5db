#include "hil/diagnose/answer/ranking.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "hil/diagnose/between/between_records.h"

namespace forcegate::diagnose {

namespace {

// From which RMS on an effect would reach its threshold on these records: half the square of strength over uncertainty, less
// what the prior of a strength costs.
double visible_from(const ResidualChannel& channel, const FamilyScore& family, double threshold) {
  const std::vector<int>& columns = columns_of(channel, family.best.variant);
  if (columns.size() != 1 || !family.best.fit.valid) return 0.0;
  const int column = columns.front();
  const double u = family.best.fit.standard_error_of(column), prior = channel.problem.column_prior_sd[column];
  double mean_square = 0.0;
  for (const RecordGram& g : channel.problem.records)
    mean_square += g.gram(channel.problem.nz + column, channel.problem.nz + column);
  const double rms =
      std::sqrt(mean_square / std::max<double>(1.0, static_cast<double>(channel.problem.records.size())));
  return u > 0.0 ? u * rms * std::sqrt(2.0 * (threshold + std::log(std::max(1.0, prior / u)))) : 0.0;
}

bool is_listed(const Diagnosis& d, const std::string& effect) {
  return std::ranges::any_of(d.findings, [&](const Finding& f) { return f.effect == effect && f.rival_of.empty(); });
}

bool is_claimed(const Diagnosis& d, const std::string& effect) {
  return std::ranges::any_of(d.findings, [&](const Finding& f) { return f.effect == effect && f.claimed(); });
}

}  // namespace

void add_ranking(const CampaignInput& input, const ResidualChannel& channel, const Selection& selection, const SelectionRules& rules,
                 Diagnosis& out) {
  for (const FamilyScore& family : selection.first.families) {
    RankedEffect r;
    r.effect = family.kind->name;
    r.side = family.kind->side;
    r.form = candidate_of(channel, family.best.variant).form->name;
    r.score = family.gain;
    r.alone = std::clamp(family.best.fall, 0.0, 1.0);
    const bool by_levels = family.records.valid && family.kind->traits.between_records;
    r.visible_from = by_levels ? visible_between_records(input, channel, selection.first.base, family, rules)
                                          : visible_from(channel, family, threshold_of(family.kind->name, rules));
    if (family.best.wrong_sign)
      r.note = "wrong sign";
    else if (by_levels && !(r.visible_from > 0.0) && !is_listed(out, r.effect))
      r.note = "these records would show it at no size";
    for (const ChosenEffect& c : selection.chosen)
      if (c.kind == family.kind) r.probability = c.share_of_family;
    // what the final model loses without it, or still gains with it
    std::vector<int> columns = selection.final.columns;
    // all of its family: another form or shape of it would take over what one leaves
    const auto is_own = [&](int j) {
      return std::ranges::any_of(channel.candidates, [&](const Candidate& c) { return c.kind == family.kind && c.owns(j); });
    };
    const bool in = std::ranges::any_of(columns, is_own);
    if (selection.excess_before > 0.0 && (in || family.gain > 3.0)) {
      if (in) {
        std::erase_if(columns, is_own);
      } else {
        for (int j : columns_of(channel, family.best.variant)) columns.push_back(j);
      }
      const MixedFit other = fit_mixed(channel.problem, columns, &selection.final, 5, RecordUse::all_records);
      if (other.valid) {
        const double change = excess_mean_square(channel, other) - selection.excess_after;
        r.unique = std::clamp((in ? change : -change) / selection.excess_before, 0.0, 1.0);
      }
    }
    out.ranking.push_back(std::move(r));
  }
  std::stable_sort(out.ranking.begin(), out.ranking.end(),
                   [](const RankedEffect& a, const RankedEffect& b) { return a.score > b.score; });
}

void state_probabilities(Diagnosis& out) {
  for (RankedEffect& r : out.ranking)
    if (const auto f = std::ranges::find(out.findings, r.effect, &Finding::effect); f != out.findings.end()) r.probability = f->probability;
}

void tell_visible_from(Diagnosis& out) {
  // one that two channels ask about shows where the better of them sees it
  std::vector<std::pair<std::string, double>> from;
  for (const RankedEffect& r : out.ranking) {
    if (!is_between_records(r.effect) || !(r.visible_from > 0.0) || is_claimed(out, r.effect)) continue;
    const auto known = std::ranges::find(from, r.effect, &std::pair<std::string, double>::first);
    if (known == from.end()) from.emplace_back(r.effect, r.visible_from);
    else known->second = std::min(known->second, r.visible_from);
  }
  std::string text;
  for (const auto& [effect, size] : from) {
    char part[80];
    std::snprintf(part, sizeof part, "%s%s %.2g %%", text.empty() ? "" : ", ", effect.c_str(), 100.0 * size);
    text += part;
  }
  if (!text.empty())
    out.notes.push_back(
        "beside the scatter of these records an effect between them would show from about (RMS, of the span): " +
        text + "; for less, repeat one slow ramp before and after, several times each");
}

}  // namespace forcegate::diagnose
