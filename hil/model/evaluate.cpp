#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/model/model.h"

namespace forcegate {

ModelEffect model_effect(const EffectKind& kind, const EffectForm& form, std::span<const double> shape,
                         std::span<const Estimate> strength) {
  const auto parameter = [](const ParameterSpec& s, double value, double se) {
    return ModelParameter{s.name, s.unit, value, se, std::min(s.minimum, value), std::max(s.maximum, value), s.neutral};
  };
  ModelEffect out{kind.name, form.name, {}, {}};
  for (std::size_t k = 0; k < form.shape.size(); ++k)
    out.shape.push_back(parameter(form.shape[k], shape[k], 0.0));
  for (std::size_t k = 0; k < form.strength.size(); ++k) {
    const ParameterSpec& s = form.strength[k];
    out.strength.push_back(parameter(s, strength[k].value, strength[k].se));
  }
  return out;
}

Result<std::vector<double>> model_output_V(const Model& model, const CampaignInFrame& campaign,
                                           const RecordInput& record) {
  std::vector<double> out = base_output_V(record, model.law);
  const double gain = 1.0 / model.law.gain_N_per_V;
  for (const ModelEffect& effect : model.effects) {
    const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
    const EffectForm* form = kind != nullptr ? find_form(*kind, effect.form) : nullptr;
    if (form == nullptr || kind->channel != EffectChannel::output) continue;
    std::vector<double> shape;
    for (const ModelParameter& p : effect.shape) shape.push_back(p.value);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()),
                                                    static_cast<Eigen::Index>(effect.strength.size()));
    form->columns(campaign.input(), record, shape, columns);
    for (std::size_t j = 0; j < effect.strength.size(); ++j)
      for (std::size_t i = 0; i < record.rows(); ++i) {
        const double added = gain * effect.strength[j].value * columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        if (!std::isfinite(added))
          return fail(ErrorCode::config, fmt::format("the effect {} ({}) gives a value that is not finite at {:.4g} s", effect.effect, effect.form, record.t_s[i]), record.name,
                      "check its shape in the model file: bounds that the file widens may leave what the effect can be computed for");
        out[i] += added;
      }
  }
  for (const UserEffect& effect : model.user_effects) {
    FORCEGATE_TRY(const std::vector<double> added, user_effect_N(effect, record));
    for (std::size_t i = 0; i < record.rows(); ++i) out[i] += gain * added[i];
  }
  return out;
}

}  // namespace forcegate
