#include "hil/diagnose/found_parameters.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/physical_parameters.h"
#include "hil/diagnose/shape_covariance.h"

namespace forcegate::diagnose {

namespace {

// Of a mounting that no record has, nothing is known.
bool is_zero(const ResidualChannel& channel, int column) {
  return std::ranges::all_of(channel.problem.records, [&](const RecordGram& r) { return r.gram(channel.problem.nz + column, channel.problem.nz + column) == 0.0; });
}

}  // namespace

std::vector<FoundParameter> found_parameters(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen) {
  std::vector<int> variants = {chosen.variant};
  variants.insert(variants.end(), chosen.further.begin(), chosen.further.end());
  const ShapeCovariance joint = shape_covariance(campaign, channel, chosen.fit, variants);
  std::vector<FoundParameter> out = physical_parameters(campaign, channel, chosen, joint);
  if (!out.empty()) return out;
  // strengths were fitted beside a working gain: they are shares of the gain that is fitted with them
  const double fitted = chosen.fit.coefficient[0] * channel.gain_of_unit;
  const double gain = chosen.kind->channel == EffectChannel::output && std::abs(fitted) > 0.05 ? fitted : 1.0;
  for (const int v : variants) {
    const Variant& variant = channel.variants[static_cast<std::size_t>(v)];
    const Candidate& c = channel.candidates[static_cast<std::size_t>(variant.candidate)];
    // a family with several forms has parameters of the same name
    const std::string of = v == chosen.variant ? "" : c.form->name + ".";
    for (std::size_t k = 0; k < c.shape.size(); ++k) {
      const ParameterSpec& spec = c.form->shape[k];
      if (!spec.choice) out.push_back({of + spec.name, c.shape[k], joint.of_shape(v, k), spec.unit});
    }
    for (std::size_t b = 0; b < chosen.fit.columns.size(); ++b)
      for (int column : variant.columns)
        if (chosen.fit.columns[b] == column && !is_zero(channel, column)) {
          const ParameterSpec& spec = c.form->strength[static_cast<std::size_t>(column - c.first)];
          const auto at = channel.problem.n_fixed + static_cast<Eigen::Index>(b);
          out.push_back({of + spec.name, chosen.fit.coefficient[at] / gain, joint.of_coefficient(at) / std::abs(gain), spec.unit});
        }
  }
  return out;
}

}  // namespace forcegate::diagnose
