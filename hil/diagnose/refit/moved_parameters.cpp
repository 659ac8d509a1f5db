#include "hil/diagnose/refit/moved_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

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

const EffectForm* form_of(const ModelEffect& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
  return kind == nullptr ? nullptr : find_form(*kind, effect.form);
}

bool is_choice(const EffectForm* form, std::size_t k) { return form != nullptr && k < form->shape.size() && form->shape[k].choice; }

// Fitted, or taken from the grid of a form that is not refined; what a refit left where it was is neither.
bool is_found(const EffectForm* form, std::size_t k, const ModelParameter& p) {
  return p.se > 0.0 || (form != nullptr && !form->refine && !is_choice(form, k));
}

// How far a shape moved, in the decades of its parameters; choices that differ weigh more than any of them.
double distance(const ModelEffect& a, const ModelEffect& b) {
  constexpr double kOtherChoice = 1e3;
  const EffectForm* form = form_of(a);
  double out = 0.0;
  for (std::size_t k = 0; k < a.shape.size(); ++k) {
    const double x = a.shape[k].value, y = b.shape[k].value;
    if (is_choice(form, k)) out += x == y ? 0.0 : kOtherChoice;
    else out += x * y > 0.0 ? std::abs(std::log10(x / y)) : std::abs(x - y);
  }
  return out;
}

// What each was: the entries of one form are paired, the nearest shapes first, and one that is left over is new.
std::vector<const ModelEffect*> entries_before(const std::vector<ModelEffect>& before, const std::vector<ModelEffect>& after) {
  std::vector<const ModelEffect*> out(after.size(), nullptr);
  std::vector<char> taken(before.size(), 0);
  for (;;) {
    std::size_t old = before.size(), now = after.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < after.size(); ++i)
      for (std::size_t k = 0; k < before.size(); ++k)
        if (out[i] == nullptr && taken[k] == 0 && same_form(after[i], before[k]) && distance(after[i], before[k]) < least)
          least = distance(after[i], before[k]), now = i, old = k;
    if (now == after.size()) return out;
    out[now] = &before[old];
    taken[old] = 1;
  }
}

}  // namespace

std::vector<ParameterMove> moved_parameters(const std::vector<ModelEffect>& before, const std::vector<ModelEffect>& after) {
  std::vector<ParameterMove> out;
  const std::vector<const ModelEffect*> entries = entries_before(before, after);
  for (std::size_t i = 0; i < after.size(); ++i) {
    const ModelEffect& effect = after[i];
    const std::string of = name_of(effect, after) + ".";
    const ModelEffect* old = entries[i];
    for (std::size_t j = 0; j < effect.strength.size(); ++j) {
      const ModelParameter& p = effect.strength[j];
      out.push_back({of + p.name, p.unit, old != nullptr ? old->strength[j].value : p.neutral, p.value, p.se});
    }
    for (std::size_t j = 0; j < effect.shape.size(); ++j) {
      const ModelParameter& p = effect.shape[j];
      if (old != nullptr) out.push_back({of + p.name, p.unit, old->shape[j].value, p.value, p.se});
      // a shape without its strength has no value to begin with; a choice is part of the name
      else if (is_found(form_of(effect), j, p)) out.push_back({of + p.name, p.unit, kMissing, p.value, p.se});
    }
  }
  return out;
}

}  // namespace forcegate::diagnose
