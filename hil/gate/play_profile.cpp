#include "hil/gate/play_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/gate/settled_rows.h"
#include "hil/interface/controller.h"
#include "hil/rig/control_period.h"
#include "hil/rig/rig_witness.h"
#include "hil/rig/self_check.h"

namespace forcegate {

Result<void> play_profile(Rig& rig, const Stimulus& stimulus, RigRecordRequest request,
                          const SafetyLimits& safety, const ProfileSink& sink,
                          const std::atomic<bool>* cancelled, PlayedProfile& out, const ProfileSaver& saver) {
  SafetyGate gate(rig, safety);
  const StimulusFacts facts = stimulus.facts();
  request.duration_s = stimulus.duration_s();
  request.force_low_N = facts.minimum_N;
  request.force_high_N = facts.maximum_N;
  FORCEGATE_CHECK_OK(gate.begin(request));
  out = {};
  out.rig = rig.info();
  const ControllerKind* kind = Registry<ControllerKind>::instance().find("open_loop");
  if (kind == nullptr) return fail(ErrorCode::internal, "the open-loop controller is not linked");
  const auto controller = kind->make();
  controller->reset(out.rig.geometry);
  RigWitness witness;
  witness.begin(out.rig);
  witness.zero_before(rig.reference_zero());
  const double rate_Hz = out.rig.rate_Hz;
  const auto [step, period_s] = control_period(rate_Hz);
  RigBlock block;
  block.resize(step * 400);
  std::vector<float> commanded(block.size());
  const auto total = static_cast<std::uint64_t>(std::llround(request.duration_s * rate_Hz));
  out.expected_samples = total;
  SettledRows settled(rate_Hz);
  const auto save = [&](std::size_t end) -> Result<void> {
    const std::size_t from = settled.saved();
    if (!saver || end <= from) return {};
    settled.save_until(end);
    return saver(block, from, end - from);
  };
  while (out.samples < total && !gate.report().stopped()) {
    std::size_t rows = 0;
    settled.next_block();
    while (rows < block.size() && out.samples + rows < total) {
      ControllerInput in;
      in.t_s = static_cast<double>(out.samples + rows) / rate_Hz;
      in.period_s = period_s;
      in.setpoint_N = stimulus.force_N(in.t_s);
      in.setpoint_next_N = stimulus.force_N(std::min(in.t_s + in.period_s, request.duration_s));
      in.theta_rad = rig.theta_rad();
      FORCEGATE_TRY(const double told, gate.command(controller->velocity_rad_per_s(in)));
      FORCEGATE_TRY(const std::size_t got,
                    gate.run(std::min<std::uint64_t>(step, total - out.samples - rows), block, rows));
      if (got == 0) break;
      for (std::size_t i = rows; i < rows + got; ++i) {
        block.setpoint_N[i] = static_cast<float>(in.setpoint_N);
        commanded[i] = static_cast<float>(told);
      }
      rows += got;
      FORCEGATE_CHECK_OK(save(settled.due(rows)));
    }
    if (rows == 0) break;
    FORCEGATE_CHECK_OK(save(rows));
    witness.push(block, rows, commanded.data());
    if (sink) sink(block, rows);
    out.samples += rows;
    if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed))
      return fail(ErrorCode::cancelled, "interrupted");
  }
  rig.park();
  out.rig.details = rig.info().details;  // with what the instruments counted
  witness.zero_after(rig.reference_zero());
  out.observed = witness.finish();
  out.safety = gate.report();
  const auto checks = self_check(out.rig, out.observed);
  if (const Check* bad = first_unsound(checks))
    return fail(ErrorCode::device, bad->title + ": " + bad->evidence);
  if (out.safety.stopped())
    return fail(ErrorCode::safety, fmt::format("the record was stopped at {:.1f} s: {}", out.safety.t_s,
                                               to_string(out.safety.reason)));
  if (out.samples < total)
    return fail(ErrorCode::timeout,
                fmt::format("the record is truncated: {} of {} samples", out.samples, total));
  return {};
}

}  // namespace forcegate
