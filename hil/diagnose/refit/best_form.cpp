#include "hil/diagnose/refit/best_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "hil/base/text.h"
#include "hil/diagnose/between/between_records.h"
#include "hil/diagnose/between/mounting_places.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

constexpr int kRounds = 15;
constexpr double kWorthClimbing = 0.5;  // nats

// Of the last column of a fit, as a model file writes it.
Estimate last_strength(const ResidualChannel& channel, const MixedFit& fit) {
  const double gain = fit.coefficient[0] * channel.gain_of_unit;
  return {fit.strength_of(fit.columns.back()) / gain, fit.standard_error_of(fit.columns.back()) / std::abs(gain)};
}

// A strength that no such effect has, plainly: what the screen leaves room for where a column is hardly known is no bound for a model file.
bool is_nonsense(const EffectForm& form, const Estimate& s) {
  if (form.strength.size() != 1 || (form.most > 1e299 && form.least < -1e299)) return false;
  const ParameterSpec& bound = form.strength.front();
  return (s.value > bound.maximum && s.value > form.most + s.se) || (s.value < bound.minimum && s.value < form.least - s.se);
}

bool is_nonsense(const ResidualChannel& channel, const VariantScore& score) {
  return columns_of(channel, score.variant).size() == 1 &&
         is_nonsense(*candidate_of(channel, score.variant).form, last_strength(channel, score.fit));
}

// A variant of the form in spare columns.
int place(const CampaignInput& input, ResidualChannel& channel, const EffectKind& kind, const EffectForm& form, const std::vector<double>& shape, unsigned threads) {
  const int at = place_candidate(channel, {&kind, &form, shape, 0, static_cast<int>(form.strength.size())});
  const Candidate& c = channel.candidates.back();
  Variant variant{at, {}};
  for (int j = 0; j < c.count; ++j) variant.columns.push_back(c.first + j);
  channel.variants.push_back(std::move(variant));
  fill_candidate(input, channel, c, threads);
  return static_cast<int>(channel.variants.size()) - 1;
}

// Where the best one of the grid is none that the effect can have: the best of those that are, its shape moved as long as it stays one.
std::optional<VariantScore> best_within(Workspace& w, const EffectKind& kind, const std::vector<int>& present, const MixedFit& base, unsigned threads) {
  ResidualChannel& channel = w.output;
  const auto score_of = [&](int variant) {
    VariantScore score = score_variant(channel, present, base, variant, nullptr);
    if (!score.fit.valid || is_nonsense(channel, score)) score.gain = -1e300;
    return score;
  };
  VariantScore best;
  best.gain = -1e299;
  for (std::size_t v = 0; v < channel.variants.size(); ++v) {
    const Candidate& c = candidate_of(channel, static_cast<int>(v));
    if (c.kind != &kind || !c.form->competes() || c.form->last) continue;
    if (VariantScore score = score_of(static_cast<int>(v)); score.gain > best.gain) best = std::move(score);
  }
  if (!best.fit.valid) return std::nullopt;
  const EffectForm& form = *candidate_of(channel, best.variant).form;
  std::vector<double> shape = candidate_of(channel, best.variant).shape;
  if (shape.empty() || !form.refine || columns_of(channel, best.variant).size() != form.strength.size()) return best;
  const int tried = place(w.input, channel, kind, form, shape, threads);
  double top = best.gain;
  climb(form, shape, [&](const std::vector<double>& at) {
    channel.candidates.back().shape = at;
    fill_candidate(w.input, channel, channel.candidates.back(), threads, &present);
    const double gain = score_of(tried).gain;
    if (gain > top) top = gain, shape = at;
    return gain;
  });
  channel.candidates.back().shape = shape;
  fill_candidate(w.input, channel, channel.candidates.back(), threads);
  return score_of(tried);
}

double left_by(const VariantScore& score) { return std::accumulate(score.fit.adapted.begin(), score.fit.adapted.end(), 0.0); }

// The bank of a diagnosis is nothing that a model says or a firmware undoes: a law that leaves hardly more takes its place.
void prefer_law(Workspace& w, const std::vector<int>& present, const MixedFit& base, unsigned threads, FamilyScore& family) {
  constexpr double kHardlyMore = 1.04;  // mean square
  ResidualChannel& channel = w.output;
  if (!soaks_up(*family.kind, *candidate_of(channel, family.best.variant).form)) return;
  FamilyScore law;
  law.kind = family.kind;
  for (std::size_t v = 0; v < channel.variants.size(); ++v) {
    const Candidate& c = candidate_of(channel, static_cast<int>(v));
    if (c.kind != family.kind || !c.form->competes() || c.form->last || soaks_up(*c.kind, *c.form)) continue;
    VariantScore score = score_variant(channel, present, base, static_cast<int>(v), nullptr);
    if (score.fit.valid && score.gain > law.best.gain) law.best = std::move(score);
  }
  if (!law.best.fit.valid) return;
  refine_family(w.input, channel, present, base, law, threads);
  if (!is_nonsense(channel, law.best) && left_by(law.best) < kHardlyMore * left_by(family.best)) family.best = std::move(law.best);
}

// What the bounds turned away at every point of the grid may be within them beyond its end: there the strength makes up for the shape.
Result<VariantScore> beyond_grid(Workspace& w, const EffectKind& kind, const std::vector<int>& present, const MixedFit& base, unsigned threads) {
  ResidualChannel& channel = w.output;
  const auto gain_of = [&](int variant) {
    std::vector<int> columns = present;
    add_columns(columns, columns_of(channel, variant));
    const MixedFit fit = fit_mixed(channel.problem, columns, &base, 9, base.use);
    return std::pair{fit.valid ? fit.log_evidence - base.log_evidence : -1e300, fit};
  };
  double best = -1e299;
  int from = -1;
  Estimate asked;
  for (std::size_t v = 0; v < channel.variants.size(); ++v) {
    const Candidate& c = candidate_of(channel, static_cast<int>(v));
    if (c.kind != &kind || !c.form->competes() || c.form->last) continue;
    const auto [gain, fit] = gain_of(static_cast<int>(v));
    const bool turned = c.form->sign != StrengthSign::either && fit.valid && (last_strength(channel, fit).value < 0.0) != (c.form->sign == StrengthSign::negative);
    if (gain > best && !turned) best = gain, from = static_cast<int>(v), asked = last_strength(channel, fit);
  }
  if (from < 0) return fail(ErrorCode::config, "the campaign cannot show " + kind.name, w.input.name, "its columns have no values on these records");
  const EffectForm& form = *candidate_of(channel, from).form;
  std::vector<double> shape = candidate_of(channel, from).shape;
  if (!shape.empty() && form.refine) {
    const int tried = place(w.input, channel, kind, form, shape, threads);
    double top = -1e300;
    for (double before = -1e301; top > before + kWorthClimbing;) {
      before = top;
      climb(form, shape, [&](const std::vector<double>& at) {
        channel.candidates.back().shape = at;
        fill_candidate(w.input, channel, channel.candidates.back(), threads, &present);
        const auto [gain, fit] = gain_of(tried);
        if (gain > top) top = gain, shape = at, asked = last_strength(channel, fit);
        return gain;
      });
    }
    channel.candidates.back().shape = shape;
    fill_candidate(w.input, channel, channel.candidates.back(), threads);
    VariantScore score = score_variant(channel, present, base, tried, nullptr);
    if (score.fit.valid && score.gain > -1e299 && !is_nonsense(channel, score)) return score;
  }
  const ParameterSpec& strength = form.strength.front();
  return fail(ErrorCode::config,
              "the campaign cannot show " + kind.name +
                  fmt::format(": the records ask for {} = {:.3g}, and it has {:.3g} to {:.3g}", strength.name, asked.value,
                              std::max(form.least, strength.minimum), std::min(form.most, strength.maximum)),
              w.input.name, "another effect does the like: forcegate diagnose compares them");
}

std::string told(Need need) {
  switch (need) {
    case Need::theta: return "the angle of the wheel (theta_rad)";
    case Need::drive: return "the drive voltage (drive_V)";
    case Need::command: return "the commanded force (F_cmd_N)";
    case Need::witness: return "the angle of the wheel or the commanded force (theta_rad, F_cmd_N)";
    case Need::generic: return "a single recording of another machine, without a declared kind";
  }
  return {};
}

Unexpected not_listed(const Workspace& w, const EffectKind& kind) {
  const std::string text = "the campaign cannot show " + kind.name;
  if (w.input.single && kind.traits.needs_records)
    return fail(ErrorCode::config, text + ": it acts from record to record, and this is one recording", w.input.name, "record several, and give their folder");
  std::vector<std::string> needs;
  if (!is_available(kind, w.input))
    for (const Need need : kind.needs) needs.push_back(told(need));
  if (!needs.empty()) return fail(ErrorCode::config, text + ": it needs " + join(needs, " and "), w.input.name, "record it too, or map its column with --map");
  return fail(ErrorCode::config, text + ": what it follows was not recorded, or is a function of the force in every record", w.input.name, kind.separates);
}

}  // namespace

Result<VariantScore> best_form(Workspace& w, const std::string& name, const std::vector<int>& present, const MixedFit* warm, unsigned threads) {
  const EffectKind& kind = *kind_of(w, name);
  const std::vector<const EffectKind*> listed = kinds_of(w.output);
  if (std::ranges::find(listed, &kind) == listed.end()) return not_listed(w, kind);
  std::vector<std::string> others;
  for (const EffectKind* other : listed)
    if (other->name != name) others.push_back(other->name);
  if (name == "mounting") place_mountings(w, present, warm, threads);
  if (shows_in_levels(kind) && !w.input.single) {
    ScreenResult result = screen(w.output, present, others, warm, threads);
    judge_between_records(w.input, w.output, present, SelectionRules{}, result);
    const bool by_records = !result.families.empty() && result.families.front().records.valid &&
                            result.families.front().records.variant == result.families.front().best.variant;
    if (by_records && (kind.traits.between_records || result.families.front().records.same_strength)) return std::move(result.families.front().best);
  }
  ScreenResult result = screen_alone(w.output, present, others, warm, threads);
  if (!result.families.empty()) {
    refine_family(w.input, w.output, present, result.base, result.families.front(), threads);
    prefer_law(w, present, result.base, threads, result.families.front());
    if (!is_nonsense(w.output, result.families.front().best)) return std::move(result.families.front().best);
    if (std::optional<VariantScore> within = best_within(w, kind, present, result.base, threads)) return *std::move(within);
  }
  return beyond_grid(w, kind, present, result.base, threads);
}

std::optional<WrittenForms> written_forms(Workspace& w, const std::vector<ModelEffect>& effects, const std::string& name, const std::vector<int>& present,
                                          const MixedFit& before, unsigned threads) {
  const EffectKind* kind = EffectRegistry::instance().find(name);
  if (kind == nullptr) return std::nullopt;
  WrittenForms out{{}, {}, before};
  std::vector<int> all = present;
  for (const ModelEffect& effect : effects) {
    if (effect.effect != name) continue;
    const EffectForm* form = find_form(*kind, effect.form);
    if (form == nullptr || form->strength.size() != effect.strength.size()) return std::nullopt;
    std::vector<double> shape;
    for (const ModelParameter& p : effect.shape) shape.push_back(p.value);
    const int at = place(w.input, w.output, *kind, *form, shape, threads);
    FamilyScore family;
    family.kind = kind;
    family.best = score_variant(w.output, all, out.fit, at, nullptr);
    if (!family.best.fit.valid || !(family.best.gain > -1e299)) return std::nullopt;
    if (form->refine && !kind->traits.between_records) refine_family(w.input, w.output, all, out.fit, family, threads);
    if (is_nonsense(w.output, family.best)) return std::nullopt;
    const std::vector<int>& columns = columns_of(w.output, family.best.variant);
    add_columns(all, columns);
    add_columns(out.columns, columns);
    out.variants.push_back(family.best.variant);
    out.fit = fit_mixed(w.output.problem, all, &family.best.fit, kRounds);
    if (!out.fit.valid) return std::nullopt;
  }
  if (out.variants.empty()) return std::nullopt;
  return out;
}

}  // namespace forcegate::diagnose
