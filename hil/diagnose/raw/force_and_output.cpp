#include "hil/diagnose/raw/force_and_output.h"

#include <cmath>

namespace forcegate::diagnose {

namespace {

std::optional<std::vector<double>> padded(const Channel& channel, std::size_t n) {
  if (channel.value.size() == n) return std::nullopt;
  std::vector<double> out = channel.value;
  out.resize(n, kMissing);
  return out;
}

}  // namespace

ForceAndOutput::ForceAndOutput(const TimeBase& clock, const Channel& force, const Channel& output)
    : clock_(&clock),
      force_(&force),
      output_(&output),
      padded_F_N_(padded(force, clock.t_s.size())),
      padded_U_V_(padded(output, clock.t_s.size())) {}

std::optional<ForceAndOutput> ForceAndOutput::of(const Trace& trace) {
  const Channel *force = trace.find("F_ref"), *output = trace.find("U");
  if (force == nullptr || output == nullptr) return std::nullopt;
  return ForceAndOutput(trace.time_bases[force->time_base], *force, *output);
}

JointSquares joint_squares(std::span<const double> F, std::span<const double> U) {
  JointSquares out;
  double mean_F = 0.0, mean_U = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (!std::isfinite(F[i] + U[i])) continue;
    out.n += 1.0;
    const double dF = F[i] - mean_F, dU = U[i] - mean_U;
    mean_F += dF / out.n;
    mean_U += dU / out.n;
    out.FF += dF * (F[i] - mean_F);
    out.FU += dF * (U[i] - mean_U);
    out.UU += dU * (U[i] - mean_U);
  }
  return out;
}

}  // namespace forcegate::diagnose
