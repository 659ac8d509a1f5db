#include "hil/diagnose/refit/joint_shapes.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/answer/shape_covariance.h"
#include "hil/diagnose/candidates/signatures.h"

namespace forcegate::diagnose {

namespace {

using Shapes = std::vector<std::vector<double>>;  // of each variant

Candidate& candidate_at(ResidualChannel& channel, int variant) {
  return channel.candidates[static_cast<std::size_t>(channel.variants[static_cast<std::size_t>(variant)].candidate)];
}

Shapes shapes_of(ResidualChannel& channel, const std::vector<int>& variants) {
  Shapes out;
  for (const int v : variants) out.push_back(candidate_at(channel, v).shape);
  return out;
}

void stand_at(Workspace& w, const std::vector<int>& variants, const Shapes& shapes, unsigned threads, const std::vector<int>* beside) {
  for (std::size_t k = 0; k < variants.size(); ++k) {
    Candidate& c = candidate_at(w.output, variants[k]);
    if (c.shape == shapes[k] && beside != nullptr) continue;
    c.shape = shapes[k];
    fill_candidate(w.input, w.output, c, threads, beside);
  }
}

Shapes moved(const Workspace& w, const std::vector<int>& variants, Shapes shapes, const ShapeCovariance& joint, double share) {
  constexpr double kMost = 0.5;  // of a shape
  for (std::size_t s = 0; s < joint.shapes.size(); ++s) {
    const auto& [variant, index] = joint.shapes[s];
    const ParameterSpec& spec = candidate_of(w.output, variant).form->shape[index];
    double& value = shapes[static_cast<std::size_t>(std::ranges::find(variants, variant) - variants.begin())][index];
    const double most = value != 0.0 ? kMost * std::abs(value) : spec.maximum - spec.minimum;
    value = std::clamp(value + share * std::clamp(joint.step[static_cast<Eigen::Index>(s)], -most, most), spec.minimum, spec.maximum);
  }
  return shapes;
}

}  // namespace

void move_together(Workspace& w, const std::vector<int>& variants, MixedFit& fit, unsigned threads) {
  constexpr int kMostSteps = 8, kRounds = 15;
  constexpr double kWorth = 0.02;  // nats
  const Shapes began = shapes_of(w.output, variants);
  for (int step = 0; step < kMostSteps; ++step) {
    const ShapeCovariance joint = shape_covariance(w.input, w.output, fit, variants);
    if (joint.shapes.size() < 2) break;
    const Shapes stood = shapes_of(w.output, variants);
    double gain = 0.0;
    for (const double share : {1.0, 0.5, 0.25}) {
      stand_at(w, variants, moved(w, variants, stood, joint, share), threads, &fit.columns);
      MixedFit tried = fit_mixed(w.output.problem, fit.columns, &fit, kRounds, fit.use);
      if (!tried.valid || !(tried.log_evidence > fit.log_evidence)) continue;
      gain = tried.log_evidence - fit.log_evidence;
      fit = std::move(tried);
      break;
    }
    if (gain == 0.0) stand_at(w, variants, stood, threads, &fit.columns);
    if (gain < kWorth) break;
  }
  if (const Shapes ended = shapes_of(w.output, variants); ended != began) stand_at(w, variants, ended, threads, nullptr);
}

}  // namespace forcegate::diagnose
