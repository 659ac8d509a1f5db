#include "hil/diagnose/refit/moved_parameters.h"

#include <fmt/format.h>

#include <algorithm>

namespace forcegate::diagnose {

namespace {

bool same_form(const ModelEffect& a, const ModelEffect& b) { return a.effect == b.effect && a.form == b.form; }

std::string name_of(const ModelEffect& effect, const std::vector<ModelEffect>& all) {
  const auto effects = std::ranges::count(all, effect.effect, &ModelEffect::effect);
  const auto forms = std::ranges::count_if(all, [&](const ModelEffect& e) { return same_form(e, effect); });
  std::string out = effect.effect;
  if (effects > 1) out += "." + effect.form;
  if (forms > 1) {
    out += "[";
    for (const ModelParameter& p : effect.shape) out += fmt::format("{}{}={:.3g}", &p == effect.shape.data() ? "" : ", ", p.name, p.value);
    out += "]";
  }
  return out;
}

// What it was: of entries of one form the one whose choices are the same, else the first.
const ModelEffect* entry_before(const ModelEffect& effect, const std::vector<ModelEffect>& before) {
  const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
  const EffectForm* form = kind == nullptr ? nullptr : find_form(*kind, effect.form);
  const ModelEffect* out = nullptr;
  for (const ModelEffect& e : before) {
    if (!same_form(e, effect)) continue;
    bool chosen_alike = true;
    for (std::size_t k = 0; form != nullptr && k < form->shape.size(); ++k)
      chosen_alike &= !form->shape[k].choice || e.shape[k].value == effect.shape[k].value;
    if (chosen_alike) return &e;
    if (out == nullptr) out = &e;
  }
  return out;
}

}  // namespace

std::vector<ParameterMove> moved_parameters(const std::vector<ModelEffect>& before, const std::vector<ModelEffect>& after) {
  std::vector<ParameterMove> out;
  for (const ModelEffect& effect : after) {
    const std::string of = name_of(effect, after) + ".";
    const ModelEffect* old = entry_before(effect, before);
    for (std::size_t j = 0; j < effect.strength.size(); ++j) {
      const ModelParameter& p = effect.strength[j];
      out.push_back({of + p.name, p.unit, old != nullptr ? old->strength[j].value : p.neutral, p.value, p.se});
    }
    // a shape without its strength has no value to begin with
    for (std::size_t j = 0; old != nullptr && j < effect.shape.size(); ++j) {
      const ModelParameter& p = effect.shape[j];
      out.push_back({of + p.name, p.unit, old->shape[j].value, p.value, p.se});
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
