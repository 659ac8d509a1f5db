#include "hil/model/model.h"

namespace forcegate {

Result<std::vector<double>> model_output_V(const Model& model, const CampaignInput& campaign, const RecordInput& record) {
  std::vector<double> out = base_output_V(record, model.law);
  const double gain = 1.0 / model.law.gain_N_per_V;
  for (const ModelEffect& effect : model.effects) {
    const EffectKind* kind = EffectRegistry::instance().find(effect.effect);
    const EffectForm* form = kind != nullptr ? find_form(*kind, effect.form) : nullptr;
    if (form == nullptr || kind->channel != EffectChannel::output) continue;
    std::vector<double> shape;
    for (const ModelParameter& p : effect.shape) shape.push_back(p.value);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()), static_cast<Eigen::Index>(effect.strength.size()));
    form->columns(campaign, record, shape, columns);
    for (std::size_t j = 0; j < effect.strength.size(); ++j)
      for (std::size_t i = 0; i < record.rows(); ++i)
        out[i] += gain * effect.strength[j].value * columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  for (const UserEffect& effect : model.user_effects) {
    FORCEGATE_TRY(const std::vector<double> added, user_effect_N(effect, record));
    for (std::size_t i = 0; i < record.rows(); ++i) out[i] += gain * added[i];
  }
  return out;
}

}  // namespace forcegate
