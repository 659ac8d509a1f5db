#include "hil/diagnose/refit/refit.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <optional>

#include "hil/base/text.h"
#include "hil/diagnose/answer/shape_covariance.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/between/foretold.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/choose/further_forms.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/one_zero.h"
#include "hil/diagnose/refit/best_form.h"
#include "hil/diagnose/refit/moved_parameters.h"

namespace forcegate::diagnose {

namespace {

// Root of the mean of squares of records, those set aside that nothing foretells beside the variants `between`.
double held_out_rms(const Workspace& w, std::vector<double> square, const std::vector<int>& between) {
  for (const int variant : between) set_unforetold_aside(w.output, variant, w.judges, square);
  return w.output.scale * std::sqrt(judged(w.output, square, w.judges));
}

// As a diagnosis judges: both models follow a record by the spreads of the base. What an effect between records changes (variants `between`), a
// record's own gain and zero would hide.
double held_out_rms(const Workspace& w, const MixedFit& fit, const MixedFit& base, const std::vector<int>& between) {
  return held_out_rms(w, between.empty() ? judge(w.output, fit, base, w.judges).adapted : judge_levels(w.output, fit, base, w.judges), between);
}

ModelEffect effect_of(const Workspace& w, int index, const MixedFit& fit, const ShapeCovariance& joint) {
  const Variant& variant = w.output.variants[static_cast<std::size_t>(index)];
  const Candidate& c = w.output.candidates[static_cast<std::size_t>(variant.candidate)];
  // the strengths were fitted beside the working gain; the law carries its own
  const double gain = fit.coefficient[0] * w.output.gain_of_unit;
  std::vector<Estimate> strength(static_cast<std::size_t>(c.count));
  for (int j = 0; j < c.count; ++j)
    for (std::size_t b = 0; b < fit.columns.size(); ++b)
      if (fit.columns[b] == c.first + j) {
        const auto at = w.output.problem.n_fixed + static_cast<Eigen::Index>(b);
        strength[static_cast<std::size_t>(j)] = {fit.coefficient[at] / gain, joint.of_coefficient(at) / std::abs(gain)};
      }
  ModelEffect out = model_effect(*c.kind, *c.form, c.shape, strength);
  for (std::size_t k = 0; k < out.shape.size(); ++k) out.shape[k].se = joint.of_shape(index, k);
  return out;
}

// `chain`: the fits by which the model was made, with the first k effects each. One error has one value: no fit of them is made anew.
Waterfall waterfall_of(const Workspace& w,
                       const std::vector<std::pair<std::string, std::vector<int>>>& effects,
                       const std::vector<MixedFit>& chain, const std::vector<int>& between) {
  const MixedFit& base = chain.front();
  Waterfall out;
  const std::size_t n = effects.size();
  out.all_orders = n <= 4;
  const auto error_of = [&](unsigned mask) {
    const auto taken = static_cast<std::size_t>(std::popcount(mask));
    if (mask == (1u << taken) - 1u) return held_out_rms(w, chain[taken], base, between);
    std::vector<int> columns = base.columns;
    for (std::size_t k = 0; k < n; ++k)
      if ((mask >> k & 1u) != 0)
        columns.insert(columns.end(), effects[k].second.begin(), effects[k].second.end());
    const MixedFit fit = fit_mixed(w.output.problem, columns, &base, 10);
    return fit.valid ? held_out_rms(w, fit, base, between) : kMissing;
  };
  const unsigned all = (1u << std::min<std::size_t>(n, 16)) - 1u;
  std::vector<double> error(out.all_orders ? all + 1u : 0u);
  for (unsigned mask = 0; mask < error.size(); ++mask) error[mask] = error_of(mask);
  out.start = out.all_orders ? error[0] : error_of(0);
  out.end = out.all_orders ? error[all] : error_of(all);
  unsigned mask = 0;
  double now = out.start;
  for (std::size_t k = 0; k < n; ++k) {
    Waterfall::Bar bar;
    bar.effect = effects[k].first;
    mask |= 1u << k;
    const double next = out.all_orders ? error[mask] : error_of(mask);
    bar.as_added = bar.average = bar.low = bar.high = now - next;
    if (std::isfinite(next)) now = next;
    if (out.all_orders) {
      // mean over subsets with the Shapley weights; range over all subsets
      bar.low = 1e300;
      bar.high = -1e300;
      bar.average = 0.0;
      for (unsigned s = 0; s <= all; ++s) {
        if ((s >> k & 1u) != 0) continue;
        const double fall = error[s] - error[s | 1u << k];
        int size = 0;
        for (unsigned b = s; b != 0; b >>= 1) size += static_cast<int>(b & 1u);
        double weight = 1.0 / static_cast<double>(n);
        for (int q = 0; q < size; ++q)
          weight *= static_cast<double>(q + 1) / static_cast<double>(static_cast<int>(n) - 1 - q);
        bar.average += weight * fall;
        bar.low = std::min(bar.low, fall);
        bar.high = std::max(bar.high, fall);
      }
      if (!std::isfinite(bar.average)) bar.low = bar.high = kMissing;  // an order that cannot be fitted
    }
    bar.hollow = !(bar.low > 0.0);
    out.bars.push_back(bar);
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
    return fail(ErrorCode::usage, "no effect \"" + add + "\"", "forcegate add", near.empty() ? "" : "did you mean \"" + near + "\"?");
  }
  if (kind->channel != EffectChannel::output)
    return fail(ErrorCode::config, add + " is not an effect of the sensor: it is mended at the " + kind->side + ", not in the model", "forcegate add",
                kind->separates);
  if (std::ranges::find(names, add) != names.end())
    return fail(ErrorCode::config, "the model has " + add + " already", start.name, "forcegate fit refits it");
  names.push_back(add);
  return names;
}

// The law alone, then with one effect more each time.
struct FittedEffects {
  std::vector<MixedFit> chain;  ///< front: the law; back: all of them
  std::vector<int> variants;    ///< every form that was taken
  std::vector<std::pair<std::string, std::vector<int>>> columns;  ///< of each effect
  const MixedFit& law() const { return chain.front(); }
  const MixedFit& all() const { return chain.back(); }
};

Result<FittedEffects> fit_effects(Workspace& w, const Model& start, const std::vector<std::string>& names, bool adds, unsigned threads, std::vector<std::string>& notes) {
  FittedEffects out;
  // what a diagnosis carries along is no error of the model here either
  // but a lead that is to be added has a claim to the whole of it, as in the diagnosis
  const EffectKind* last = names.empty() ? nullptr : kind_of(w, names.back());
  const bool leads = adds && last != nullptr && last->traits.shift == TimeShift::percent_lead;
  out.chain.push_back(law_beside(w, {}, !leads && std::ranges::find(names, kLatencyEffect) == names.end(), notes));
  if (!out.law().valid) return fail(ErrorCode::config, "the records do not determine the model", w.input.name, "more records, or records with more force");
  std::vector<int> present = out.law().columns;
  for (const std::string& name : names) {
    const auto best = best_form(w, name, present, &out.all(), threads);
    // where the model stands is a start as good as any: a fit ends no worse than it began
    std::optional<WrittenForms> written = written_forms(w, start.effects, name, present, out.all(), threads);
    if (!best && !written) return Unexpected(best.error());
    WrittenForms taken;
    if (best) {
      const Variant& variant = w.output.variants[static_cast<std::size_t>(best->variant)];
      std::vector<int> all = present;
      all.insert(all.end(), variant.columns.begin(), variant.columns.end());
      taken = {{best->variant}, {}, fit_mixed(w.output.problem, all, &best->fit, 15)};
      const EffectKind& kind = *w.output.candidates[static_cast<std::size_t>(variant.candidate)].kind;
      if (!kind.traits.between_records)
        for (const int v : further_forms(w.output, kind, all, taken.fit)) taken.variants.push_back(v);
      taken.columns.assign(all.begin() + std::ssize(present), all.end());
    }
    if (written && (!taken.fit.valid || written->fit.log_evidence > taken.fit.log_evidence)) taken = *std::move(written);
    present.insert(present.end(), taken.columns.begin(), taken.columns.end());
    out.variants.insert(out.variants.end(), taken.variants.begin(), taken.variants.end());
    out.chain.push_back(std::move(taken.fit));
    out.columns.emplace_back(name, std::move(taken.columns));
  }
  return out;
}

void write_law(const Workspace& w, const MixedFit& fit, const ShapeCovariance& joint, const Model& start, Refit& out) {
  const auto se = [&](int k) { return joint.of_coefficient(k); };
  Model& m = out.model;
  m.law = w.law;
  // a law of decay that no record shows and some contradict would bend every later record
  const auto is = [&](auto which) { return std::any_of(w.input.records.begin(), w.input.records.end(), which); };
  if (is([](const RecordInput& r) { return r.found_static; }) && !is([](const RecordInput& r) { return r.dynamic && !r.found_static; })) m.law.decays = false;
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
}

void write_user_effect(const Workspace& w, const MixedFit& fit, const ShapeCovariance& joint, int variant, const Candidate& c, UserEffect& own, Refit& out) {
  for (std::size_t b = 0; b < fit.columns.size(); ++b) {
    if (fit.columns[b] != c.first) continue;
    const auto at = w.output.problem.n_fixed + static_cast<Eigen::Index>(b);
    const UserEffect before_fit = own;
    const double gain = fit.coefficient[0] * w.output.gain_of_unit;
    std::vector<Estimate> shape;
    for (std::size_t k = 0; k < c.shape.size(); ++k) shape.push_back({c.shape[k], joint.of_shape(variant, k)});
    own = with_fit(before_fit, *c.form, shape, {fit.coefficient[at] / gain, joint.of_coefficient(at) / std::abs(gain)});
    for (const ModelParameter& p : own.parameters) {
      double old = p.neutral;  // a share is new
      for (const ModelParameter& q : before_fit.parameters) old = q.name == p.name ? q.value : old;
      out.moves.push_back({own.name + "." + p.name, p.unit, old, p.value, p.se});
    }
  }
}

void write_effects(const Workspace& w, const FittedEffects& fitted, const ShapeCovariance& joint, const Model& start, Refit& out) {
  Model& m = out.model;
  m.effects.clear();
  const std::ptrdiff_t law_moves = std::ssize(out.moves);
  for (const int v : fitted.variants) {
    const Candidate& c = w.output.candidates[static_cast<std::size_t>(w.output.variants[static_cast<std::size_t>(v)].candidate)];
    const auto own = std::ranges::find(m.user_effects, c.kind->name, &UserEffect::name);
    if (own != m.user_effects.end()) write_user_effect(w, fitted.all(), joint, v, c, *own, out);
    else m.effects.push_back(effect_of(w, v, fitted.all(), joint));
  }
  const std::vector<ParameterMove> library = moved_parameters(start.effects, m.effects);
  out.moves.insert(out.moves.begin() + law_moves, library.begin(), library.end());
}

// Errors of records that were left out, before (without what was added, or without all) and after, and the step in the model's history.
void measure(Workspace& w, const FittedEffects& fitted, const std::string& add, Refit& out) {
  const MixedFit &law = fitted.law(), &now = fitted.all(), &before = add.empty() ? law : fitted.chain[fitted.chain.size() - 2];
  if (!fitted.columns.empty() && whole_must_judge(w, law, now)) w.judges = JudgedBy::whole;
  out.judged_by = w.judges;
  std::vector<int> between;
  std::ranges::copy_if(fitted.variants, std::back_inserter(between), [&](int v) {
    return w.output.candidates[static_cast<std::size_t>(w.output.variants[static_cast<std::size_t>(v)].candidate)].kind->traits.between_records;
  });
  out.levels = !between.empty();
  out.error_before = held_out_rms(w, before, law, between);
  out.error_after = held_out_rms(w, now, law, between);
  out.plain_before = held_out_rms(w, judge(w.output, before, law, w.judges).plain, between);
  out.plain_after = held_out_rms(w, judge(w.output, now, law, w.judges).plain, between);
  std::vector<double> noise;
  for (const double noise_V : w.noise_V) noise.push_back(noise_V * noise_V / (w.output.scale * w.output.scale));
  out.floor = std::min(held_out_rms(w, std::move(noise), between), out.error_after);
  out.waterfall = waterfall_of(w, fitted.columns, fitted.chain, between);
  out.waterfall.floor = out.floor;
  out.waterfall.unit = w.output.unit;
  HistoryStep step;
  step.effect = add;
  step.campaign = w.input.name;
  step.error_before = out.error_before;
  step.error_after = out.error_after;
  step.plain_before = out.plain_before;
  step.plain_after = out.plain_after;
  step.floor = out.floor;
  step.unit = w.output.unit;
  step.accepted = add.empty() || out.error_after < out.error_before;
  out.model.history.push_back(step);
}

}  // namespace

Result<Refit> refit_model(Workspace& w, const Model& start, const std::string& add, unsigned threads) {
  Refit out;
  FORCEGATE_TRY(const std::vector<std::string> names, effects_to_fit(w, start, add));
  FORCEGATE_TRY(const FittedEffects fitted, fit_effects(w, start, names, !add.empty(), threads, out.notes));
  const MixedFit& now = fitted.all();
  if (!now.valid)
    return fail(ErrorCode::config, "the records do not determine the model with " + (add.empty() ? "its effects" : add), w.input.name,
                "more records, or a model with fewer effects");
  const ShapeCovariance joint = shape_covariance(w.input, w.output, now, fitted.variants);
  constexpr double kKnown = 2.0;  // of its standard error
  if (!(std::abs(now.coefficient[0]) > kKnown * joint.of_coefficient(0)))
    return fail(ErrorCode::config, "the records do not tell the gain of the sensor: the output does not follow the force beyond the noise", w.input.name,
                "a record in which the force moves over a good part of its range");
  out.model = start;
  out.model.frame = frame_of(w.input);
  write_law(w, now, joint, start, out);
  write_effects(w, fitted, joint, start, out);
  measure(w, fitted, add, out);
  return out;
}

namespace {

Result<Refit> refit_rows(CampaignRows rows, const EngineOptions& options, const Model& start, const std::string& add) {
  FORCEGATE_TRY(const std::unique_ptr<Workspace> w, prepare(std::move(rows), options));
  return refit_model(*w, start, add, options.threads);
}

}  // namespace

Result<Refit> refit_campaign(Campaign campaign, const EngineOptions& options, const Model& start, const std::string& add) {
  FORCEGATE_TRY(CampaignRows rows, take_rows(std::move(campaign), options));
  if (!rows.input.single) return refit_rows(std::move(rows), options, start, add);
  FORCEGATE_TRY(Refit stands, refit_rows(rows, with_one_zero(options), start, add));
  FORCEGATE_TRY(Refit wanders, refit_rows(std::move(rows), options, start, add));
  return one_zero_is_enough(stands.plain_after, wanders.plain_after, stands.floor) ? std::move(stands) : std::move(wanders);
}

}  // namespace forcegate::diagnose
