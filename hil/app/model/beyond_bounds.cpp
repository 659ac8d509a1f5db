#include "hil/app/model/beyond_bounds.h"

#include <fmt/format.h>

#include "hil/base/text.h"

namespace forcegate {

std::vector<std::string> beyond_bounds_notes(const Model& model) {
  std::vector<std::string> out;
  for (const ModelEffect& effect : model.effects) {
    const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
    const EffectForm* form = kind != nullptr ? find_form(*kind, effect.form) : nullptr;
    if (form == nullptr) continue;
    for (std::size_t k = 0; k < std::min(form->strength.size(), effect.strength.size()); ++k) {
      const ParameterSpec& bound = form->strength[k];
      const ModelParameter& p = effect.strength[k];
      if (!(p.se > 0.0) || (p.value < bound.maximum && p.value > bound.minimum)) continue;
      out.push_back(fmt::format("{}.{} = {} lies {} what such an effect has ({:g} to {:g}): its form may stand in for another form or effect", effect.effect, p.name,
                                with_uncertainty(p.value, p.se), p.value == bound.maximum || p.value == bound.minimum ? "at an end of" : "beyond", bound.minimum, bound.maximum));
    }
  }
  return out;
}

}  // namespace forcegate
