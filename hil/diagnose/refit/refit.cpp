#include "hil/diagnose/refit/refit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/diagnose/answer/shape_covariance.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/base/record_spread.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/between/foretold.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/one_zero.h"
#include "hil/diagnose/refit/fitted_effects.h"
#include "hil/diagnose/refit/moved_parameters.h"
#include "hil/diagnose/refit/replaced_forms.h"
#include "hil/diagnose/refit/stands_still.h"

namespace forcegate::diagnose {

namespace {

// Root of the mean of squares of records, those set aside that nothing foretells beside the variants `between`.
double held_out_rms(const Workspace& w, std::vector<double> square, const std::vector<int>& between) {
  for (const int variant : between) set_unforetold_aside(w.output, variant, w.judges, square);
  return w.output.scale * std::sqrt(judged(w.output, square, w.judges));
}

// As a diagnosis judges: models that are compared follow a record by the same spreads, those of `freedom`. What an effect between records changes
// (variants `between`), a record's own gain and zero would hide.
double held_out_rms(const Workspace& w, const MixedFit& fit, const MixedFit& freedom, const std::vector<int>& between) {
  return held_out_rms(w, between.empty() ? judge(w.output, fit, freedom, w.judges).adapted : judge_levels(w.output, fit, freedom, w.judges), between);
}

ModelEffect effect_of(const Workspace& w, int index, const MixedFit& fit, const ShapeCovariance& joint) {
  const Candidate& c = candidate_of(w.output, index);
  // the strengths were fitted beside the working gain; the law carries its own
  const double gain = fit.coefficient[0] * w.output.gain_of_unit;
  std::vector<Estimate> strength(static_cast<std::size_t>(c.count));
  for (int j = 0; j < c.count; ++j)
    if (const auto at = fit.place_of(c.first + j)) strength[static_cast<std::size_t>(j)] = {fit.coefficient[*at] / gain, joint.of_coefficient(*at) / std::abs(gain)};
  ModelEffect out = model_effect(*c.kind, *c.form, c.shape, strength);
  for (std::size_t k = 0; k < out.shape.size(); ++k) out.shape[k].se = joint.of_shape(index, k);
  return out;
}

// `chain`: the fits by which the model was made, with the first k effects each. One error has one value: no fit of them is made anew.
ErrorsOfEffects errors_of_effects(const Workspace& w, const std::vector<std::pair<std::string, std::vector<int>>>& effects, const std::vector<MixedFit>& chain,
                                  const MixedFit& freedom, const std::vector<int>& between) {
  const MixedFit& base = chain.front();
  ErrorsOfEffects out;
  for (const auto& [name, columns] : effects) out.effects.push_back(name);
  const std::size_t n = effects.size();
  if (!out.all_orders()) {
    for (const MixedFit& fit : chain) out.error.push_back(held_out_rms(w, fit, freedom, between));
    return out;
  }
  for (unsigned mask = 0; mask < 1u << n; ++mask) {
    const auto taken = static_cast<std::size_t>(std::popcount(mask));
    if (mask == (1u << taken) - 1u) {
      out.error.push_back(held_out_rms(w, chain[taken], freedom, between));
      continue;
    }
    std::vector<int> columns = base.columns;
    for (std::size_t k = 0; k < n; ++k)
      if ((mask >> k & 1u) != 0) columns.insert(columns.end(), effects[k].second.begin(), effects[k].second.end());
    const MixedFit fit = fit_mixed(w.output.problem, columns, &base, 10);
    out.error.push_back(fit.valid ? held_out_rms(w, fit, freedom, between) : kMissing);
  }
  return out;
}

// Those of the model and the one to be added, each once: an effect may stand in the model with several forms.
Result<std::vector<std::string>> effects_to_fit(const Workspace& w, const Model& start, const std::string& add) {
  std::vector<std::string> names;
  for (const std::string& name : start.effect_names())
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  for (const UserEffect& effect : start.user_effects)
    if (is_fitted(effect)) names.push_back(effect.name);
  if (add.empty()) return names;
  const EffectKind* kind = kind_of(w, add);
  for (const UserEffect& own : start.user_effects)
    if (kind != nullptr && own.name == add) FORCEGATE_CHECK_OK(check_excited(own, *kind, w.input));
  if (kind == nullptr) {
    std::vector<std::string> known = EffectRegistry::instance().names();
    for (const UserEffect& own : start.user_effects) known.push_back(own.name);
    const std::string near = nearest_name(add, known);
    std::vector<std::string> own;
    for (const UserEffect& effect : start.user_effects) own.push_back(effect.name);
    return fail(ErrorCode::usage, "no effect \"" + add + "\"", "forcegate add",
                (near.empty() ? "" : "did you mean \"" + near + "\"? ") +
                    (own.empty() ? "an equation of your own stands in a model file: name that with --model FILE" : "the model file has the equations " + join(own, ", ")) +
                    (near.empty() ? "; forcegate explain lists the effects of the library" : ""));
  }
  if (kind->channel != EffectChannel::output)
    return fail(ErrorCode::config, add + " is not an effect of the sensor: it is mended at the " + kind->side + ", not in the model", "forcegate add",
                kind->separates);
  if (std::ranges::find(names, add) != names.end())
    return fail(ErrorCode::config, "the model has " + add + " already", start.name, "forcegate fit refits it");
  names.push_back(add);
  return names;
}

void write_law(const Workspace& w, const MixedFit& fit, const ShapeCovariance& joint, const Model& start, Refit& out) {
  const auto se = [&](int k) { return joint.of_coefficient(k) * of_few_records(records_of_column(w, fit, k)); };
  Model& m = out.model;
  m.law = w.law;
  if (none_decays(w.input)) m.law.decays = false;
  const double g = w.gain_V_per_N * fit.coefficient[0];
  m.law.gain_N_per_V = 1.0 / g;
  m.law.offset_N = -fit.coefficient[1] * w.output.scale / g;
  m.law.b_scale = w.law.b_scale * std::exp(fit.coefficient[2]);
  m.law.q_scale = w.law.q_scale * std::exp(fit.coefficient[3]);
  m.se_gain = std::abs(m.law.gain_N_per_V * se(0) / fit.coefficient[0]);
  m.se_offset = se(1) * w.output.scale / std::abs(g);
  m.se_b_scale = m.law.b_scale * se(2);
  m.se_q_scale = m.law.q_scale * se(3);
  out.moves.push_back({"gain_N_per_V", "N/V", start.law.gain_N_per_V, m.law.gain_N_per_V, m.se_gain});
  out.moves.push_back({"offset_N", "N", start.law.offset_N, m.law.offset_N, m.se_offset});
  if (!m.law.decays) return;
  out.moves.push_back({"b_scale", "1", start.law.b_scale, m.law.b_scale, m.se_b_scale});
  out.moves.push_back({"q_scale", "1", start.law.q_scale, m.law.q_scale, m.se_q_scale});
  if (m.law.loading_share != start.law.loading_share) out.moves.push_back({"loading_share", "1", start.law.loading_share, m.law.loading_share, 0.0});
}

// 1 / sqrt(2 (n - 1)): GUM, E.4.3.
void tell_few_records(std::size_t n, std::vector<std::string>& notes) {
  constexpr std::size_t kFew = 3;
  if (n < 2 || n > kFew) return;
  notes.push_back(fmt::format("the uncertainties of gain and offset rest on {} records, and what scatters between so few is known to {:.0f} %", n,
                              100.0 / std::sqrt(2.0 * static_cast<double>(n - 1))));
}

void write_user_effect(const Workspace& w, const MixedFit& fit, const ShapeCovariance& joint, int variant, const Candidate& c, const std::vector<UserEffect>& before, UserEffect& own,
                       Refit& out) {
  const double gain = fit.coefficient[0] * w.output.gain_of_unit;
  std::vector<Estimate> shape, strength;
  for (int j = 0; j < c.count; ++j) {
    const auto at = fit.place_of(c.first + j);
    if (!at) return;
    strength.push_back({fit.coefficient[*at] / gain, joint.of_coefficient(*at) / std::abs(gain)});
  }
  for (std::size_t k = 0; k < c.shape.size(); ++k) shape.push_back({c.shape[k], joint.of_shape(variant, k)});
  own = with_fit(own, *c.form, shape, strength);
  for (const ModelParameter& p : own.parameters) {
    double old = p.neutral;  // a share is new
    if (const auto was = std::ranges::find(before, own.name, &UserEffect::name); was != before.end())
      for (const ModelParameter& q : was->parameters) old = q.name == p.name ? q.value : old;
    out.moves.push_back({own.name + "." + p.name, p.unit, old, p.value, p.se});
  }
}

void write_effects(const Workspace& w, const FittedEffects& fitted, const ShapeCovariance& joint, const Model& start, Refit& out) {
  Model& m = out.model;
  m.effects.clear();
  const std::ptrdiff_t law_moves = std::ssize(out.moves);
  for (const int v : fitted.variants) {
    const Candidate& c = candidate_of(w.output, v);
    const auto own = std::ranges::find(m.user_effects, c.kind->name, &UserEffect::name);
    if (own != m.user_effects.end()) write_user_effect(w, fitted.all(), joint, v, c, start.user_effects, *own, out);
    else m.effects.push_back(effect_of(w, v, fitted.all(), joint));
  }
  const std::vector<ParameterMove> library = moved_parameters(start.effects, m.effects);
  out.moves.insert(out.moves.begin() + law_moves, library.begin(), library.end());
}

// What a refit knows beside its result: the errors of which its waterfall is made.
struct Fitted {
  Refit refit;
  ErrorsOfEffects errors;
};

HistoryStep step_of(const Refit& refit, const std::string& add, const std::string& campaign) {
  HistoryStep out;
  out.effect = add;
  out.campaign = campaign;
  out.error_before = refit.error_before;
  out.error_after = refit.error_after;
  out.plain_before = refit.plain_before;
  out.plain_after = refit.plain_after;
  out.floor = refit.floor;
  out.unit = refit.waterfall.unit;
  out.accepted = add.empty() || lowers_error(refit.error_before, refit.error_after);
  return out;
}

// `unit` is a copy: it may be that of `out`.
void draw_waterfall(const ErrorsOfEffects& errors, std::string unit, Refit& out) {
  out.waterfall = waterfall_of(errors);
  out.waterfall.floor = out.floor;
  out.waterfall.unit = std::move(unit);
}

// Errors of records that were left out, before (without what was added, or without all) and after.
void measure(Workspace& w, const FittedEffects& fitted, bool adds, Fitted& made) {
  Refit& out = made.refit;
  const MixedFit &law = fitted.law(), &now = fitted.all(), &before = adds ? fitted.chain[fitted.chain.size() - 2] : law;
  if (!fitted.columns.empty() && whole_must_judge(w, law, now)) w.judges = JudgedBy::whole;
  out.judged_by = w.judges;
  std::vector<int> between;
  std::ranges::copy_if(fitted.variants, std::back_inserter(between), [&](int v) {
    return moves_levels(candidate_of(w.output, v));
  });
  out.levels = !between.empty();
  // what is added by the spreads of the diagnosis that proposed it, a model by its own: a law that lacks its effects takes its errors for noise
  const MixedFit& freedom = adds ? before : now;
  out.error_before = held_out_rms(w, before, freedom, between);
  out.error_after = held_out_rms(w, now, freedom, between);
  out.plain_before = held_out_rms(w, judge(w.output, before, freedom, w.judges).plain, between);
  std::vector<double> plain = judge(w.output, now, freedom, w.judges).plain;
  for (const double square : plain) out.plain_after_of_record.push_back(w.output.scale * std::sqrt(square));
  out.plain_after = held_out_rms(w, std::move(plain), between);
  std::vector<double> noise;
  for (const double noise_V : w.noise_V) noise.push_back(noise_V * noise_V / (w.output.scale * w.output.scale));
  out.floor = std::min(held_out_rms(w, std::move(noise), between), out.error_after);
  made.errors = errors_of_effects(w, fitted.columns, fitted.chain, freedom, between);
  draw_waterfall(made.errors, w.output.unit, out);
}

// `at`: the model that the workspace was prepared with, from whose effects the fit begins; `start`: that which the user has.
Result<Fitted> refit_at(Workspace& w, const Model& start, const Model& at, const std::string& add, unsigned threads) {
  Fitted made;
  Refit& out = made.refit;
  FORCEGATE_TRY(const std::vector<std::string> names, effects_to_fit(w, start, add));
  // a lead that is to be added has a claim to the whole of it, as in the diagnosis
  const EffectKind* added = add.empty() ? nullptr : kind_of(w, add);
  const bool leads = added != nullptr && added->traits.shift == TimeShift::percent_lead;
  FORCEGATE_TRY(const FittedEffects fitted, fit_effects(w, at, names, leads, threads, out.notes));
  const MixedFit& now = fitted.all();
  if (!now.valid)
    return fail(ErrorCode::config, "the records do not determine the model with " + (add.empty() ? "its effects" : add), w.input.name,
                "more records, or a model with fewer effects");
  const ShapeCovariance joint = shape_covariance(w.input, w.output, now, fitted.variants);
  constexpr double kKnown = 2.0;  // of its standard error
  const bool known_without = std::abs(fitted.law().coefficient[0]) > kKnown * std::sqrt(std::max(0.0, fitted.law().covariance(0, 0)));
  const bool is_known = std::abs(now.coefficient[0]) > kKnown * joint.of_coefficient(0);
  if (!is_known && known_without && !fitted.columns.empty())
    return fail(ErrorCode::config, fmt::format("with {} the records do not tell the gain of the sensor any more: some of it goes with the force as the gain itself does",
                                               add.empty() ? "its effects" : add),
                w.input.name, "take out what is proportional to F, which gain_N_per_V is, or constant, which offset_N is; or record more");
  if (!is_known)
    return fail(ErrorCode::config, "the records do not tell the gain of the sensor: the output does not follow the force beyond the noise", w.input.name,
                "a record in which the force moves over a good part of its range");
  out.model = start;
  out.model.user_effects = at.user_effects;
  out.model.frame = frame_of(w.input);
  write_law(w, now, joint, start, out);
  tell_few_records(records_of_column(w, now, 0), out.notes);
  write_effects(w, fitted, joint, start, out);
  measure(w, fitted, !add.empty(), made);
  out.model.history.push_back(step_of(out, add, w.input.name));
  return made;
}

EngineOptions options_at(EngineOptions options, const Model& model) {
  options.law = model.law;
  options.in_model = model.effect_names();
  options.model_effects = model.effects;
  options.user_effects = model.user_effects;
  for (const UserEffect& own : model.user_effects)
    if (is_fitted(own)) options.in_model.push_back(own.name);
  return options;
}

Result<Fitted> refit_prepared(CampaignRows rows, const EngineOptions& options, const Model& start, const Model& at, const std::string& add, JudgedBy judged_by) {
  if (judged_by == JudgedBy::whole) rows.judges = judged_by;
  FORCEGATE_TRY(const std::unique_ptr<Workspace> w, prepare(std::move(rows), options));
  return refit_at(*w, start, at, add, options.threads);
}

// The errors before from where the model before stands: along the lines of the model after, its law goes astray.
void take_before(const Fitted& of_before, const std::string& add, Fitted& made) {
  Refit& out = made.refit;
  if (of_before.refit.judged_by != out.judged_by || of_before.refit.levels != out.levels) return;
  out.error_before = of_before.refit.error_before;
  out.plain_before = of_before.refit.plain_before;
  // subsets and beginnings without the last effect come first
  std::vector<double>& error = made.errors.error;
  const std::size_t without = add.empty() ? 1 : made.errors.all_orders() ? error.size() / 2 : error.size() - 1;
  std::copy_n(of_before.errors.error.begin(), without, error.begin());
  draw_waterfall(made.errors, out.waterfall.unit, out);
  out.model.history.back() = step_of(out, add, out.model.history.back().campaign);
}

// The law without any effect beside it, in place of a refit of it; nullopt: there is none.
std::optional<Fitted> law_alone(CampaignRows rows, const EngineOptions& options, const Model& start, JudgedBy judged_by) {
  Model law = start;
  law.effects.clear();
  law.user_effects.clear();
  Result<Fitted> out = refit_prepared(std::move(rows), options_at(options, law), law, law, "", judged_by);
  return out ? std::optional(*std::move(out)) : std::nullopt;
}

}  // namespace

bool lowers_error(double before, double after) {
  constexpr double kFalls = 0.999;  // less is what a strength of nothing, fitted to noise, brings
  return after < kFalls * before;
}

Result<Refit> refit_model(Workspace& w, const Model& start, const std::string& add, unsigned threads) {
  FORCEGATE_TRY(Fitted made, refit_at(w, start, start, add, threads));
  return std::move(made.refit);
}

namespace {

Result<Refit> refit_rows(const CampaignRows& rows, const EngineOptions& options, const Model& start, const std::string& add) {
  constexpr int kMostTimes = 10;
  bool still = false;
  std::string why;
  FORCEGATE_TRY(const Fitted first, refit_prepared(rows, options, start, start, add, rows.judges));
  Fitted made = first;
  // without a decay too: spreads and shapes begin where the fit before ended
  for (int time = 1; time < kMostTimes && !still; ++time) {
    const Model at = made.refit.model;
    Result<Fitted> next = refit_prepared(rows, options_at(options, at), start, at, add, first.refit.judged_by);
    if (!next) {
      why = fmt::format(" ({})", next.error().text);
      break;
    }
    made = *std::move(next);
    still = stands_still(at, made.refit.model);
  }
  if (!still)
    made.refit.notes.push_back(fmt::format("the fit does not stand still: one more from where it ended would move its parameters{}", why));
  for (std::string& note : replaced_forms(start, made.refit.model)) made.refit.notes.push_back(std::move(note));
  if (!add.empty()) {
    take_before(first, add, made);
  } else if (!made.refit.levels && !made.errors.effects.empty()) {
    if (const std::optional<Fitted> law = law_alone(rows, options, start, made.refit.judged_by)) take_before(*law, add, made);
  }
  return std::move(made.refit);
}

}  // namespace

Result<Refit> refit_campaign(Campaign campaign, const EngineOptions& options, const Model& start, const std::string& add) {
  FORCEGATE_TRY(const CampaignRows rows, take_rows(std::move(campaign), options));
  FORCEGATE_TRY(Refit out, refit_rows(rows, rows.input.single ? with_one_zero(options) : options, start, add));
  if (rows.input.single) {
    FORCEGATE_TRY(Refit wanders, refit_rows(rows, options, start, add));
    if (!one_zero_is_enough(out.plain_after, wanders.plain_after, out.floor)) out = std::move(wanders);
  }
  if (std::string note = note_of_claims(rows.raw_claims); !note.empty()) out.notes.push_back(std::move(note));
  return out;
}

Result<Refit> refit_prepared_rows(const Workspace& w, const EngineOptions& options, const Model& start, const std::string& add) {
  return refit_rows({w.input, w.health, w.edges, w.raw_claims, w.scales, w.output.unit, w.judges}, w.zero_wanders ? options : with_one_zero(options), start, add);
}

}  // namespace forcegate::diagnose
