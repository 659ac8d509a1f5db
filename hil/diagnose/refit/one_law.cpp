#include "hil/diagnose/refit/one_law.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/law_fitter.h"
#include "hil/diagnose/refit/replaced_forms.h"
#include "hil/diagnose/refit/seen_terms.h"

namespace forcegate::diagnose {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kFirstRounds = 1;
constexpr double kWorth = 0.97;  // an effect must lower the error of left-out records to this

std::vector<FormAtShape> variants_of(const EffectKind& kind, const std::vector<FormAtShape>& beside, const CampaignInput& input) {
  std::vector<FormAtShape> out;
  for (const EffectForm& form : kind.forms) {
    if (form.outlasts) continue;  // a firmware does not know what was before it
    if (soaks_up(kind, form)) continue;
    if (!form.beside.empty() && std::ranges::none_of(beside, [&](const FormAtShape& c) { return c.kind->name == form.beside; })) continue;
    for (std::vector<double>& shape : form.grid(input)) out.push_back({&kind, &form, std::move(shape)});
  }
  return out;
}

// Law and effects of the joint fit; uncertainties from the jackknife over records, those of log b and log q as given.
Model assembled(const Model& start, const CampaignInput& input, const BaseLaw& law, const std::vector<FormAtShape>& effects, const std::vector<LawGram>& grams,
                const Eigen::Vector2d& se_of_decay) {
  const VectorXd all = LawFitter::solve(grams, grams.size());
  const auto n = static_cast<double>(grams.size());
  VectorXd mean = VectorXd::Zero(all.size()), square = mean;
  for (std::size_t k = 0; k < grams.size(); ++k) {
    const VectorXd beta = LawFitter::solve(grams, k);
    mean += beta / n;
    square += beta.cwiseProduct(beta) / n;
  }
  const VectorXd se = ((square - mean.cwiseProduct(mean)).cwiseMax(0.0) * (n - 1.0)).cwiseSqrt();
  Model m = start;
  m.law = law;
  m.frame = frame_of(input);
  const double g = all[0];
  m.law.gain_N_per_V = 1.0 / g;
  m.law.offset_N = -all[1] / g;
  m.se_gain = se[0] / (g * g);
  m.se_offset = se[1] / std::fabs(g);
  m.se_b_scale = law.b_scale * se_of_decay[0];
  m.se_q_scale = law.q_scale * se_of_decay[1];
  m.effects.clear();
  std::vector<UserEffect> own;
  Index at = 2;
  for (const FormAtShape& c : effects) {
    std::vector<Estimate> strength, shape;
    for (std::size_t k = 0; k < c.form->strength.size(); ++k, ++at) strength.push_back({all[at] / g, se[at] / std::fabs(g)});
    for (const double value : c.shape) shape.push_back({value, 0.0});
    const auto equation = std::ranges::find(start.user_effects, c.kind->name, &UserEffect::name);
    if (equation == start.user_effects.end())
      m.effects.push_back(model_effect(*c.kind, *c.form, c.shape, strength));
    else
      own.push_back(with_fit(*equation, *c.form, shape, strength));
  }
  m.user_effects = std::move(own);
  return m;
}

// Every effect of the model that acts on the output, once, as a kind to choose a form of.
Result<std::vector<const EffectKind*>> wanted_kinds(const Model& start, const std::vector<std::unique_ptr<EffectKind>>& own,
                                                    const CampaignInput& input) {
  std::vector<const EffectKind*> out;
  for (const ModelEffect& wanted : start.effects) {
    const EffectKind* kind = EffectRegistry::instance().find(wanted.effect);
    // the forms of one effect that a refit wrote beside each other are one effect of the sensor
    if (kind == nullptr || kind->channel != EffectChannel::output || std::ranges::find(out, kind) != out.end()) continue;
    if (!is_available(*kind, input))
      return fail(ErrorCode::config, "the campaign lacks a channel that " + wanted.effect + " needs", input.name);
    out.push_back(kind);
  }
  for (const auto& kind : own) out.push_back(kind.get());
  return out;
}

// The best variant so far, with what was chosen before it.
struct Trial {
  double left_out_V = 1e300;
  std::vector<FormAtShape> effects;
  BaseLaw law;
};

// The best one that can be used, none where none can: asked from the best on, since an answer may take a compiler.
Result<Trial> best_usable(LawFitter& fitter, const Model& start, std::vector<Trial>& trials, const IsUsable& is_usable) {
  std::ranges::stable_sort(trials, {}, &Trial::left_out_V);
  for (const Trial& t : trials) {
    if (!is_usable) return t;
    FORCEGATE_TRY(const std::vector<LawGram> grams, fitter.grams(t.law, t.effects));
    if (is_usable(assembled(start, fitter.input(), t.law, t.effects, grams, Eigen::Vector2d::Zero()))) return t;
  }
  return Trial{};
}

// Samples that a fit throws out are thrown out here too, and it is decided from the output which records decay. Every row counts.
struct FittedRows {
  CampaignInput input;
  std::string unit;            ///< of the output
  double loading_share = 0.0;  ///< of the clock that the decay keeps to
};
Result<FittedRows> rows_as_fitted(Campaign campaign, const Model& start, unsigned threads) {
  constexpr std::size_t kFewest = 3;
  const auto too_few = [name = campaign.name] {
    return fail(ErrorCode::config, "one law for all records needs at least three of them", name, "forcegate record makes a campaign");
  };
  if (campaign.records.size() < kFewest) return too_few();
  EngineOptions options;
  options.law = start.law;
  options.model_name = start.name;
  options.in_model = start.effect_names();
  options.threads = threads;
  options.pictures = options.search = false;
  FORCEGATE_TRY(const std::unique_ptr<Workspace> w, prepare(std::move(campaign), options));
  if (w->input.records.size() < kFewest) return too_few();
  for (RecordInput& r : w->input.records) {
    r.wanted.clear();
    r.recording = w->input.records.front().recording;  // a firmware is switched on where the record begins: what the film kept it cannot know
  }
  return FittedRows{std::move(w->input), w->output.unit, w->law.loading_share};
}

std::string cost_of(const Trial& usable, const Trial& best, const PrintedUnit& unit) {
  const std::string& wanted = best.effects.back().form->name;
  const std::string& taken = usable.effects.back().form->name;
  const std::string costs = fmt::format("and leaves {:.3g} {} of error instead of {:.3g}", unit.factor * usable.left_out_V, unit.name,
                                        unit.factor * best.left_out_V);
  const std::string& effect = best.effects.back().kind->name;
  if (wanted == taken)
    return fmt::format("{}: the form {} predicts best with parameters with which it cannot be undone; with others it can, {}", effect, wanted, costs);
  return fmt::format("{}: the form {} predicts best, but it cannot be undone; {} can, {}", effect, wanted, taken, costs);
}

// Law and effects as they grow, with the sums of the rows for them.
struct Growing {
  BaseLaw law;
  std::vector<FormAtShape> effects;
  std::vector<LawGram> grams;
};

// Every form and shape of one more effect; b and q have soaked up what is missing, so that each is judged with its own.
Result<std::vector<Trial>> trials_of(LawFitter& fitter, const EffectKind& kind, const Growing& so_far) {
  std::vector<Trial> out;
  for (FormAtShape& variant : variants_of(kind, so_far.effects, fitter.input())) {
    std::vector<FormAtShape> with = so_far.effects;
    with.push_back(variant);
    FORCEGATE_TRY(const BaseLaw own, fitter.refine(so_far.law, with, kFirstRounds));
    FORCEGATE_TRY(const std::vector<LawGram> grams, fitter.grams(own, with));
    if (const double left_out_V = LawFitter::left_out(grams); std::isfinite(left_out_V)) out.push_back({left_out_V, std::move(with), own});
  }
  return out;
}

// Takes the best form of an effect in that can be used, or the best where none can.
Result<void> take_in(LawFitter& fitter, const EffectKind& kind, const Model& start, const IsUsable& is_usable, const std::string& unit,
                     Growing& so_far, std::vector<std::string>& notes) {
  FORCEGATE_TRY(std::vector<Trial> trials, trials_of(fitter, kind, so_far));
  if (trials.empty()) {
    notes.push_back(kind.name + " is left out: with one law for all records no form of it can be fitted");
    return {};
  }
  FORCEGATE_TRY(const Trial usable, best_usable(fitter, start, trials, is_usable));
  const Trial& best = trials.front();
  const bool worse = !usable.effects.empty() && usable.left_out_V > best.left_out_V;
  if (worse) notes.push_back(cost_of(usable, best, printed_unit(unit)));
  const Trial& chosen = usable.effects.empty() ? best : usable;
  so_far.effects = chosen.effects;
  note_unseen(*so_far.effects.back().kind, *so_far.effects.back().form, fitter.input(), notes);
  FORCEGATE_TRY(so_far.law, fitter.refine(chosen.law, so_far.effects));
  FORCEGATE_TRY(so_far.grams, fitter.grams(so_far.law, so_far.effects));
  return {};
}

// Of each record without and with the effects, all records fitted together.
std::vector<OneLawFit::Item> record_errors(const std::vector<RecordInput>& records, const std::vector<LawGram>& bare, const std::vector<LawGram>& with) {
  const VectorXd bare_beta = LawFitter::solve(bare, bare.size()), all = LawFitter::solve(with, with.size());
  std::vector<OneLawFit::Item> out;
  for (std::size_t k = 0; k < with.size(); ++k)
    out.push_back({records[k].name,
                   std::sqrt(LawFitter::square_error(bare[k], bare_beta)),
                   std::sqrt(LawFitter::square_error(with[k], all))});
  return out;
}

// A form that cannot be undone has its cost told already.
void note_replaced_forms(const Model& start, const Model& fitted, std::vector<std::string>& notes) {
  for (const std::string& note : replaced_forms(start, fitted)) {
    const std::string of_effect = note.substr(0, note.find(": ") + 2);
    const auto says_why = [&](const std::string& told) { return told.starts_with(of_effect); };
    if (std::ranges::none_of(notes, says_why)) notes.push_back(note + "; without --fit the model is exported as it stands");
  }
}

}  // namespace

Result<OneLawFit> fit_one_law(Campaign campaign, const Model& start, const IsUsable& is_usable, unsigned threads) {
  FORCEGATE_TRY(FittedRows rows, rows_as_fitted(std::move(campaign), start, threads));
  CampaignInput& input = rows.input;
  const std::string name = input.name;
  OneLawFit out;
  out.notes = std::move(input.notes);
  FORCEGATE_TRY(const auto own_kinds, make_user_kinds(start.user_effects, input));
  BaseLaw first = start.law;
  first.loading_share = rows.loading_share;
  if (none_decays(input)) first.decays = false;
  LawFitter fitter(std::move(input));
  Growing fit;
  FORCEGATE_TRY(fit.law, fitter.refine(first, {}));
  FORCEGATE_TRY(fit.grams, fitter.grams(fit.law, {}));
  const std::vector<LawGram> bare = fit.grams;
  FORCEGATE_TRY(const std::vector<const EffectKind*> kinds, wanted_kinds(start, own_kinds, fitter.input()));
  for (const EffectKind* kind : kinds) FORCEGATE_CHECK_OK(take_in(fitter, *kind, start, is_usable, rows.unit, fit, out.notes));
  out.law_left_out_V = LawFitter::left_out(bare);
  out.left_out_V = LawFitter::left_out(fit.grams);
  if (!fit.effects.empty() && out.left_out_V > kWorth * out.law_left_out_V)
    return fail(ErrorCode::config,
                kEffectsOfNoUse,
                name,
                "they may differ from record to record: forcegate compare shows where the error sits");

  FORCEGATE_TRY(const Eigen::Vector2d se_of_decay, fitter.jackknife_of_decay(fit.law, fit.effects));
  out.model = assembled(start, fitter.input(), fit.law, fit.effects, fit.grams, se_of_decay);
  out.records = record_errors(fitter.input().records, bare, fit.grams);
  out.model.output_unit = rows.unit;
  note_replaced_forms(start, out.model, out.notes);
  HistoryStep step;
  step.unit = rows.unit;
  step.campaign = name;
  step.one_law = true;
  step.error_before = step.plain_before = out.law_left_out_V;
  step.error_after = step.plain_after = out.left_out_V;
  out.model.history.push_back(step);
  return out;
}

}  // namespace forcegate::diagnose
