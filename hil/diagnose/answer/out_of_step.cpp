#include "hil/diagnose/answer/out_of_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/choose/reference_latency.h"

namespace forcegate::diagnose {

namespace {

// Columns that were carried along and shift the output in time.
std::vector<int> carried_shifts(const ResidualChannel& channel, const Selection& selection) {
  std::vector<int> out;
  for (const Candidate& c : channel.candidates)
    if (c.kind->traits.shift != TimeShift::none)
      for (int j = c.first; j < c.first + c.count; ++j)
        if (std::ranges::find(selection.carried, j) != selection.carried.end()) out.push_back(j);
  return out;
}

// The shift of all columns together and its standard uncertainty: it is linear in their strengths.
FoundParameter shift_of(const ResidualChannel& channel, const MixedFit& fit) {
  const double shift_s = net_shift_s(channel, fit);
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(fit.coefficient.size());
  for (Eigen::Index j = channel.problem.n_fixed; j < slope.size(); ++j) {
    MixedFit moved = fit;
    moved.coefficient[j] += 1.0;
    slope[j] = net_shift_s(channel, moved) - shift_s;
  }
  return {"delay_s", shift_s, std::sqrt(std::max(0.0, slope.dot(fit.covariance * slope))), "s"};
}

}  // namespace

std::optional<Finding> listed_out_of_step(const Workspace& w, const Selection& selection, const std::vector<Finding>& findings) {
  constexpr double kListed = 0.08;  // every other bench has a reference with a lag of its own
  constexpr int kIterations = 20;
  const EffectKind* delay = EffectRegistry::instance().find(kLatencyEffect);
  if (w.input.generic || delay == nullptr || !selection.base.valid || selection.set_aside.size() > 0) return std::nullopt;
  if (std::ranges::any_of(findings, [](const Finding& f) { return is_timing(f.effect); })) return std::nullopt;
  const ResidualChannel& channel = w.output;
  // beside a lag of the model's own a shift mends that
  if (std::ranges::any_of(channel.candidates, [](const Candidate& c) { return c.of_model && c.kind->traits.timing; })) return std::nullopt;
  const std::vector<int> shifts = carried_shifts(channel, selection);
  if (shifts.empty()) return std::nullopt;
  std::vector<int> others;
  for (const int j : selection.carried)
    if (std::ranges::find(shifts, j) == shifts.end()) others.push_back(j);
  const MixedFit with = fit_mixed(channel.problem, selection.carried, &selection.base, kIterations),
                 without = fit_mixed(channel.problem, others, &selection.base, kIterations);
  if (!with.valid || !without.valid) return std::nullopt;
  const auto error = [&](const MixedFit& fit) { return channel.scale * std::sqrt(judged(channel, judge(channel, fit, without, w.judges).adapted, w.judges)); };
  Finding out = finding_about(*delay, channel);
  out.form = "out_of_step";
  out.probability = kListed;
  out.parameters.push_back(shift_of(channel, with));
  out.error_before = error(without);
  out.error_after = error(with);
  const double late_s = out.parameters.front().value;
  out.evidence = fmt::format("the output {} the reference by {:.2g} ms; not claimed: a filter of the reference, or two clocks, do as much, and nothing here says "
                             "by how much these may be out of step",
                             late_s < 0.0 ? "leads" : "is behind", 1e3 * std::abs(late_s));
  return out;
}

}  // namespace forcegate::diagnose
