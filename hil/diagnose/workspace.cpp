#include "hil/diagnose/workspace.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

double allowed_rms(const ResidualChannel& channel) {
  double sum = 0.0;
  for (const RecordGram& g : channel.problem.records) sum += g.allowed_variance;
  return std::sqrt(sum / std::max<double>(1.0, static_cast<double>(channel.problem.records.size())));
}

Finding finding_about(const EffectKind& kind, const std::string& unit, ShownIn shown_in) {
  Finding out;
  out.effect = kind.name;
  out.side = kind.side;
  out.shown_in = shown_in;
  out.unit = unit;
  out.between_records = kind.traits.between_records;
  return out;
}

Diagnosis answer_about(const Workspace& w, const std::string& model_name) {
  Diagnosis out;
  out.campaign = w.input.name;
  out.model = model_name;
  out.single = w.input.single;
  out.unit = w.output.unit;
  out.force_range_N = w.input.range_N;
  out.voltage_range_V = w.input.U_range_V;
  return out;
}

const EffectKind* kind_of(const Workspace& w, const std::string& name) {
  for (const auto& own : w.user_kinds)
    if (own->name == name) return own.get();
  return EffectRegistry::instance().find(name);
}

}  // namespace forcegate::diagnose
