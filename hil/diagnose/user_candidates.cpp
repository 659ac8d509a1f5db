#include "hil/diagnose/user_candidates.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

constexpr const char* kShare = "share";

ParameterSpec spec_of(const ModelParameter& p) {
  ParameterSpec out{p.name, p.unit, p.minimum, p.maximum, p.value, ""};
  // without bounds, two decades around the value that the user wrote; a search never changes the sign
  const double low = p.value > 0.0 ? 0.01 * p.value : 100.0 * p.value,
               high = p.value > 0.0 ? 100.0 * p.value : 0.01 * p.value;
  if (p.value != 0.0) {
    out.minimum = std::max(out.minimum, low);
    out.maximum = std::min(out.maximum, high);
  }
  return out;
}

// The point that the user wrote, and each parameter a factor of three up and down.
std::vector<std::vector<double>> grid_of(const UserEffect& effect) {
  std::vector<double> centre;
  for (const ModelParameter& p : effect.parameters) centre.push_back(p.value);
  std::vector<std::vector<double>> out{centre};
  if (is_fitted(effect)) return out;
  for (std::size_t k = 0; k < centre.size(); ++k)
    for (const double factor : {1.0 / 3.0, 3.0}) {
      const ParameterSpec spec = spec_of(effect.parameters[k]);
      std::vector<double> shape = centre;
      shape[k] = std::clamp(factor * centre[k], spec.minimum, spec.maximum);
      if (shape[k] != centre[k]) out.push_back(std::move(shape));
    }
  return out;
}

}  // namespace

bool is_fitted(const UserEffect& effect) {
  return std::any_of(effect.parameters.begin(), effect.parameters.end(),
                     [](const ModelParameter& p) { return p.se > 0.0; });
}

Result<std::vector<std::unique_ptr<EffectKind>>> make_user_kinds(const std::vector<UserEffect>& effects,
                                                                 const CampaignInput& input) {
  std::vector<std::unique_ptr<EffectKind>> out;
  for (const UserEffect& effect : effects) {
    if (!input.records.empty()) FORCEGATE_CHECK_OK(user_effect_N(effect, input.records.front()));
    auto kind = std::make_unique<EffectKind>();
    kind->name = effect.name;
    kind->side = "sensor";
    kind->summary = "the equation of the model file";
    kind->equation = "dF = " + effect.output;
    kind->source = "model file";
    kind->separates = "a stimulus that moves its states and not those of its rivals";
    EffectForm form;
    form.name = "equation";
    for (const ModelParameter& p : effect.parameters) form.shape.push_back(spec_of(p));
    form.strength.push_back({kShare, "1", -1e3, 1e3, 0.0, "factor on the whole output of the equation"});
    form.grid = [grid = grid_of(effect)](const CampaignInput&) { return grid; };
    form.columns = [effect](const CampaignInput&, const RecordInput& record, std::span<const double> shape,
                            ColumnsRef columns) {
      columns.setZero();
      const auto added =
          user_effect_N(with_parameters(effect, {shape.begin(), shape.end()}, 1.0, 0.0), record);
      if (!added) return;  // a shape at which the equation has no value is no candidate
      for (std::size_t i = 0; i < added->size(); ++i) columns(static_cast<Eigen::Index>(i), 0) = (*added)[i];
    };
    kind->forms.push_back(std::move(form));
    out.push_back(std::move(kind));
  }
  return out;
}

UserEffect with_parameters(const UserEffect& effect, const std::vector<double>& shape, double share,
                           double share_se) {
  UserEffect out = effect;
  ModelParameter* factor = nullptr;
  for (std::size_t k = 0; k < out.parameters.size(); ++k) {
    if (k < shape.size()) out.parameters[k].value = shape[k];
    if (out.parameters[k].name == kShare) factor = &out.parameters[k];
  }
  if (share == 1.0 && share_se == 0.0) return out;
  if (factor == nullptr) {
    out.output = std::string(kShare) + " * (" + out.output + ")";
    out.parameters.push_back({kShare, "1", 1.0, 0.0, -1e3, 1e3, 0.0});
    factor = &out.parameters.back();
  }
  factor->se = std::abs(factor->value) * share_se;
  factor->value *= share;
  return out;
}

}  // namespace forcegate::diagnose
