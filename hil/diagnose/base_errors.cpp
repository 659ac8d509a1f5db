#include "hil/diagnose/base_errors.h"

#include <cmath>

#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

namespace {

constexpr int kOfAll = 18, kOfSome = 8, kOfRig = 20;  // rounds of EM

BaseError error_of(const ResidualChannel& channel, const MixedFit& base, const std::vector<double>& bad, JudgedBy by) {
  const auto rms = [&](std::vector<double> square) {
    for (std::size_t i = 0; i < square.size(); ++i) {
      square[i] *= channel.scale * channel.scale;
      if (i < bad.size()) square[i] += bad[i];
    }
    return std::sqrt(judged(channel, square, by));
  };
  return {rms(judge(channel, base, base, by).adapted), rms(judge_levels(channel, base, base, by))};
}

}  // namespace

MixedFit law_beside(const Workspace& w, const std::vector<int>& columns, bool forgives, std::vector<std::string>& notes) {
  const MixedFit of_all = fit_to_the_end(w.output, columns, nullptr, kOfAll, RecordUse::all_records);
  MixedFit base = of_all.valid ? fit_mixed(w.output.problem, columns, &of_all, kOfSome) : of_all;
  return base.valid && forgives ? forgive_late_reference(w, std::move(base), notes) : base;
}

MixedFit base_model(const Workspace& w, const EngineOptions& options, std::vector<std::string>& notes) {
  return law_beside(w, model_columns(w.output, options), true, notes);
}

Result<BaseErrors> base_errors(const Workspace& w, const EngineOptions& options) {
  std::vector<std::string> notes;
  const MixedFit base = base_model(w, options, notes);
  if (!base.valid) return fail(ErrorCode::parse, "the records do not determine the starting model", w.input.name);
  std::vector<double> bad;
  for (const RecordHealth& health : w.health) bad.push_back(health.bad_mean_square_V2);
  BaseErrors out{error_of(w.output, base, bad, w.judges), std::nullopt};
  if (!w.has_rig) return out;
  const MixedFit rig = fit_mixed(w.rig.problem, {}, nullptr, kOfRig);
  if (rig.valid) out.force = error_of(w.rig, rig, {}, w.judges);
  return out;
}

std::vector<double> plain_errors_V(const Workspace& w, const EngineOptions& options) {
  std::vector<std::string> notes;
  const MixedFit base = base_model(w, options, notes);
  if (!base.valid) return {};
  std::vector<double> out = judge(w.output, base, base, w.judges).plain;
  for (double& square : out) square = w.output.scale * std::sqrt(std::max(square, 0.0));
  return out;
}

}  // namespace forcegate::diagnose
