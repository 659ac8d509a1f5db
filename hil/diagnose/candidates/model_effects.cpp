#include "hil/diagnose/candidates/model_effects.h"

#include <algorithm>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

std::vector<double> shape_of(const ModelEffect& effect) {
  std::vector<double> out;
  for (const ModelParameter& p : effect.shape) out.push_back(p.value);
  return out;
}

// The library's kind that a model's effect of the output belongs to; null otherwise.
const EffectKind* kind_of(const ModelEffect& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
  return kind != nullptr && kind->channel == EffectChannel::output ? kind : nullptr;
}

bool is_guess(const ModelEffect& effect) {
  const auto estimated = [](const ModelParameter& p) { return p.se > 0.0; };
  return std::ranges::none_of(effect.shape, estimated) && std::ranges::none_of(effect.strength, estimated);
}

bool is_own(const Candidate& c, const EngineOptions& options) {
  return std::ranges::find(options.in_model, c.kind->name) != options.in_model.end() && EffectRegistry::instance().find(c.kind->name) != c.kind;
}

}  // namespace

std::vector<Candidate> model_candidates(const CampaignInput& campaign, const std::vector<ModelEffect>& effects) {
  std::vector<Candidate> out;
  for (const ModelEffect& effect : effects) {
    const EffectKind* kind = kind_of(effect);
    const EffectForm* form = kind != nullptr && is_available(*kind, campaign) ? find_form(*kind, effect.form) : nullptr;
    if (form == nullptr) continue;
    Candidate c{kind, form, shape_of(effect), 0, static_cast<int>(form->strength.size())};
    c.of_model = true;
    for (const ModelParameter& p : effect.strength) c.written.push_back(p.value);
    c.is_guess = is_guess(effect);
    out.push_back(std::move(c));
  }
  return out;
}

bool acts_together(const EffectKind& other, const EffectKind& with) {
  return std::ranges::any_of(other.forms, [&](const EffectForm& form) { return form.beside == with.name; });
}

std::string lacking_partner(const EngineOptions& options) {
  for (const EffectKind& partner : EffectRegistry::instance().all()) {
    const auto stands = [&](const ModelEffect& effect) {
      const EffectKind* kind = kind_of(effect);
      return kind != nullptr && acts_together(partner, *kind);
    };
    if (std::ranges::any_of(options.model_effects, stands) && std::ranges::find(options.in_model, partner.name) == options.in_model.end()) return partner.name;
  }
  return {};
}

bool is_as_shipped(const EngineOptions& options) { return std::ranges::all_of(options.model_effects, is_guess); }

std::vector<Candidate> beside_base_law(const CampaignInput& campaign, const std::vector<Candidate>& of_model) {
  std::vector<Candidate> out;
  const auto add = [&](const EffectKind& kind, const EffectForm& form) {
    for (const std::vector<double>& shape : form.grid(campaign)) out.push_back({&kind, &form, shape, 0, static_cast<int>(form.strength.size())});
  };
  for (const Candidate& own : of_model) {
    if (!own.is_guess) {
      out.push_back(own);
      continue;
    }
    add(*own.kind, *own.form);
    for (const EffectKind& other : EffectRegistry::instance().all())
      if (acts_together(other, *own.kind))
        for (const EffectForm& form : other.forms) {
          const bool lags_too = form.beside == own.kind->name && !form.bank && form.shape.size() == 1;
          if (lags_too || (form.bank && form.beside.empty())) add(other, form);
        }
  }
  return out;
}

std::vector<int> model_columns(const ResidualChannel& channel, const EngineOptions& options) {
  std::vector<int> out;
  const auto add = [&](const Candidate& c) {
    for (int j = 0; j < c.count; ++j) add_columns(out, {c.first + j});
  };
  for (const Candidate& c : channel.candidates)
    if (c.of_model || is_own(c, options)) add(c);
  return out;
}

std::vector<int> model_families(const ResidualChannel& channel, const EngineOptions& options) {
  std::vector<int> out;
  for (const ModelEffect& effect : options.model_effects)
    if (const EffectKind* kind = kind_of(effect)) add_columns(out, family_columns(channel, *kind));
  return out;
}

}  // namespace forcegate::diagnose
