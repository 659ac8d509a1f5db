#include "hil/diagnose/candidates/guessed_shapes.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

constexpr double kWorthMoving = 3.0, kWorthAnotherForm = 20.0;  // nats
constexpr double kSomething = 0.1;  // of what the instruments may leave (mean square)

struct Guess {
  const EffectForm* form = nullptr;
  std::vector<double> shape;
  double gain = -1e300, left = 0.0;  // nats; excess mean square
};

// Of the model; and of what acts together with this effect, which would bend its shape where it is missing: `companion`, or (-1) the form that
// it has alone.
std::vector<int> columns_beside(const ResidualChannel& channel, std::size_t own, int companion) {
  std::vector<int> out;
  for (std::size_t k = 0; k < channel.candidates.size(); ++k) {
    const Candidate& c = channel.candidates[k];
    if (c.of_model && k != own) add_columns(out, columns_of(c));
    if (companion < 0 && acts_together(*c.kind, *channel.candidates[own].kind) && c.form->bank && c.form->beside.empty()) add_columns(out, columns_of(c));
  }
  if (companion >= 0) add_columns(out, columns_of(channel.candidates[static_cast<std::size_t>(companion)]));
  return out;
}

// What a bent curve adds behind the guess lags as the straight line does, by whatever the guess is moved to: a bank that stands still would
// take part of the move. None (-1) where the library has no such form.
int companion_of(const ResidualChannel& channel, const Candidate& own) {
  constexpr const char* kBehind = "quartic_before_lag";
  for (std::size_t k = 0; k < channel.candidates.size(); ++k)
    if (const EffectForm& form = *channel.candidates[k].form;
        form.beside == own.kind->name && form.name == kBehind && form.shape.size() == own.form->shape.size())
      return static_cast<int>(k);
  return -1;
}

// Those that have as many shapes and strengths, and would take its place.
std::vector<const EffectForm*> other_forms(const Candidate& written, const CampaignInput& input) {
  std::vector<const EffectForm*> out;
  for (const EffectForm& form : written.kind->forms)
    if (&form != written.form && form.competes() && !form.last && form.beside.empty() && form.shape.size() == written.form->shape.size() &&
        form.strength.size() == written.form->strength.size() && !form.grid(input).empty())
      out.push_back(&form);
  return out;
}

}  // namespace

void fit_guessed_shapes(Workspace& w, unsigned threads) {
  ResidualChannel& channel = w.output;
  for (std::size_t own = 0; own < channel.candidates.size(); ++own) {
    const Candidate written = channel.candidates[own];
    const bool continuous = std::ranges::any_of(written.form->shape, [](const ParameterSpec& p) { return !p.choice; });
    if (!written.is_guess || !continuous || !written.form->refine) continue;
    const int companion = companion_of(channel, written);
    const std::vector<int> present = columns_beside(channel, own, companion);
    std::vector<int> looked_at = present;
    add_columns(looked_at, columns_of(written));
    const auto move = [&](std::size_t k, const std::vector<double>& shape, const std::vector<int>* beside) {
      channel.candidates[k].shape = shape;
      fill_candidate(w.input, channel, channel.candidates[k], threads, beside);
    };
    const std::vector<double> companion_stood = companion < 0 ? std::vector<double>{} : channel.candidates[static_cast<std::size_t>(companion)].shape;
    if (companion >= 0) move(static_cast<std::size_t>(companion), written.shape, &looked_at);
    const MixedFit base = fit_mixed(channel.problem, present, nullptr);
    if (!base.valid) {
      if (companion >= 0) move(static_cast<std::size_t>(companion), companion_stood, nullptr);
      continue;
    }
    const int variant = static_cast<int>(channel.variants.size());
    channel.variants.push_back({static_cast<int>(own), columns_of(written)});
    const auto stand_at = [&](const EffectForm& form, const std::vector<double>& shape) {
      channel.candidates[own].form = &form;
      move(own, shape, &looked_at);
      if (companion >= 0) move(static_cast<std::size_t>(companion), shape, &looked_at);
      const VariantScore score = score_variant(channel, present, base, variant, nullptr);
      return Guess{&form, shape, score.gain, score.fit.valid ? excess_mean_square(channel, score.fit) : 0.0};
    };
    const auto best_from = [&](Guess best) {
      const EffectForm& form = *best.form;
      const auto gain_at = [&](const std::vector<double>& shape) {
        const Guess here = stand_at(form, shape);
        if (here.gain > best.gain) best = here;
        return here.gain;
      };
      for (const std::vector<double>& shape : form.grid(w.input)) gain_at(shape);
      climb(form, best.shape, gain_at);
      return best;
    };
    Guess best = stand_at(*written.form, written.shape);
    if (const Guess moved = best_from(best); moved.gain > best.gain + kWorthMoving) best = moved;
    // nor does a guess know whether it is one pole or two
    for (const EffectForm* other : other_forms(written, w.input)) {
      if (best.left < kSomething * allowed_rms(channel) * allowed_rms(channel)) break;
      if (const Guess another = best_from(stand_at(*other, other->grid(w.input).front())); another.gain > best.gain + kWorthAnotherForm) best = another;
    }
    channel.candidates[own].form = best.form;
    move(own, best.shape, nullptr);
    if (companion >= 0) move(static_cast<std::size_t>(companion), companion_stood, nullptr);
    channel.variants.pop_back();
    const Candidate& c = channel.candidates[own];
    for (std::size_t k = 0; k < c.shape.size(); ++k)
      if (c.shape[k] != written.shape[k])
        w.input.notes.push_back(fmt::format("the model's {} was a guess: {} = {:.3g}{}{} fits these records, {:.3g}{} is written", written.kind->name,
                                            written.form->shape[k].name, c.shape[k], written.form->shape[k].unit == "1" ? "" : " " + written.form->shape[k].unit,
                                            c.form == written.form ? "" : " of form " + c.form->name, written.shape[k], c.form == written.form ? "" : " of form " + written.form->name));
  }
}

}  // namespace forcegate::diagnose
