#include "hil/diagnose/answer/found_parameters.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/answer/physical_parameters.h"
#include "hil/diagnose/answer/rail_voltage.h"
#include "hil/diagnose/answer/shape_covariance.h"

namespace forcegate::diagnose {

namespace {

// Of a mounting that no record has, nothing is known.
bool is_zero(const ResidualChannel& channel, int column) {
  return std::ranges::all_of(channel.problem.records, [&](const RecordGram& r) { return r.gram(channel.problem.nz + column, channel.problem.nz + column) == 0.0; });
}

}  // namespace

std::vector<FoundParameter> found_parameters(const CampaignInput& campaign, const ResidualChannel& channel, const ChosenEffect& chosen, double gain) {
  std::vector<int> variants = {chosen.variant};
  variants.insert(variants.end(), chosen.further.begin(), chosen.further.end());
  const ShapeCovariance joint = shape_covariance(campaign, channel, chosen.fit, variants);
  std::vector<FoundParameter> out = physical_parameters(campaign, channel, chosen, joint);
  for (FoundParameter& p : out) {
    p.value /= gain;
    p.u /= std::abs(gain);
  }
  if (!out.empty()) return out;
  if (chosen.kind->name == "clipping")
    if (auto rail = rail_voltage(campaign, channel, chosen)) out.push_back(std::move(*rail));
  for (const int v : variants) {
    const Candidate& c = candidate_of(channel, v);
    // a family with several forms has parameters of the same name
    const std::string of = v == chosen.variant ? "" : c.form->name + ".";
    for (std::size_t k = 0; k < c.shape.size(); ++k) {
      const ParameterSpec& spec = c.form->shape[k];
      if (!spec.choice) out.push_back({of + spec.name, c.shape[k], joint.of_shape(v, k), spec.unit});
    }
    for (const int column : columns_of(channel, v))
      if (const auto at = chosen.fit.place_of(column); at && !is_zero(channel, column)) {
        const ParameterSpec& spec = c.form->strength[static_cast<std::size_t>(column - c.first)];
        out.push_back({of + spec.name, chosen.fit.coefficient[*at] / gain, joint.of_coefficient(*at) / std::abs(gain), spec.unit});
      }
  }
  return out;
}

}  // namespace forcegate::diagnose
