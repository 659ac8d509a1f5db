#include "hil/characterize/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "hil/interface/controller.h"
#include "hil/rig/control_period.h"
#include "hil/rig/rig_witness.h"
#include "hil/rig/self_check.h"

namespace forcegate::characterize {
namespace {

constexpr std::size_t kPeriodsPerBlock = 400;

}  // namespace

double Bench::volts_per_code() const {
  const RigInfo info = rig_.info();
  return info.v_range_V / static_cast<double>((1u << info.adc_bits) - 1u);
}

Result<PlayedRecord> Bench::play(const StimulusSpec& spec, const BlockSink& sink, const Closed& closed) {
  FORCEGATE_TRY(const std::unique_ptr<Stimulus> stimulus, make_stimulus(spec));
  return play(*stimulus, sink, closed);
}

Result<PlayedRecord> Bench::play(const Stimulus& stimulus, const BlockSink& sink, const Closed& closed) {
  const StimulusFacts facts = stimulus.facts();
  const Estimator& estimator = closed.estimator;
  RigRecordRequest request;
  request.faults = closed.faults;
  request.specimen = setup_.specimen;
  request.seed = setup_.seed;
  request.session = setup_.session;
  request.record = ++record_;
  request.rest_before_s = setup_.rest_s;
  request.duration_s = stimulus.duration_s();
  request.force_low_N = facts.minimum_N;
  request.force_high_N = facts.maximum_N;
  SafetyGate gate(rig_, setup_.safety);
  FORCEGATE_CHECK_OK(gate.begin(request));
  PlayedRecord out;
  out.rig = rig_.info();
  const std::string name = estimator ? closed.controller : "open_loop";
  const ControllerKind* kind = Registry<ControllerKind>::instance().find(name);
  if (kind == nullptr) return fail(ErrorCode::internal, "the controller '" + name + "' is not linked");
  const auto controller = kind->make();
  controller->reset(out.rig.geometry);
  RigWitness witness;
  witness.begin(out.rig);

  const double rate_Hz = out.rig.rate_Hz;
  const auto [step, period_s] = control_period(rate_Hz);
  RigBlock block;
  block.resize(step * kPeriodsPerBlock);
  std::vector<double> setpoint_N(block.size() + 1);
  std::vector<float> commanded(block.size()), estimates(estimator ? block.size() : 0);
  const auto total = static_cast<std::uint64_t>(std::llround(request.duration_s * rate_Hz));
  double estimate_N = facts.minimum_N;
  std::uint64_t done = 0;
  while (done < total && !gate.report().stopped()) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), total - done));
    const double first_s = static_cast<double>(done) / rate_Hz;
    stimulus.fill(first_s, 1.0 / rate_Hz, wanted, setpoint_N.data());
    setpoint_N[wanted] =
        stimulus.force_N(std::min(static_cast<double>(done + wanted) / rate_Hz, request.duration_s));
    std::size_t rows = 0;
    while (rows < wanted) {
      ControllerInput in;
      in.t_s = static_cast<double>(done + rows) / rate_Hz;
      in.period_s = period_s;
      in.setpoint_N = setpoint_N[rows];
      in.setpoint_next_N = setpoint_N[std::min(rows + step, wanted)];
      in.estimate_N = estimate_N;
      in.theta_rad = rig_.theta_rad();
      FORCEGATE_TRY(const double told, gate.command(controller->velocity_rad_per_s(in)));
      FORCEGATE_TRY(const std::size_t got, gate.run(std::min(step, wanted - rows), block, rows));
      if (got == 0) break;
      for (std::size_t i = rows; i < rows + got; ++i) {
        block.setpoint_N[i] = static_cast<float>(setpoint_N[i]);
        commanded[i] = static_cast<float>(told);
        if (estimator) {
          estimate_N = estimator(block.adc[i]);
          estimates[i] = static_cast<float>(estimate_N);
        }
      }
      rows += got;
    }
    if (rows == 0) break;
    witness.push(block, rows, commanded.data());
    if (sink) sink(block, rows, std::span<const float>(estimates.data(), estimator ? rows : 0));
    done += rows;
    progress_.samples += rows;
    if (progress_.is_cancelled()) return fail(ErrorCode::cancelled, "interrupted");
  }
  out.samples = done;
  samples_ += done;
  out.safety = gate.report();
  const std::string where =
      fmt::format("{}, session {}, record {}", request.specimen, request.session, request.record);
  if (!out.safety.stopped() && done < total)
    return fail(ErrorCode::timeout, fmt::format("the record is truncated: {} of {} samples", done, total), where);
  // what a loop that is closed over a poor estimate does to sensor and bench is what it is played for
  if (estimator) return out;
  const auto checks = self_check(out.rig, witness.finish());
  if (const Check* bad = first_unsound(checks))
    return fail(ErrorCode::device, bad->title + ": " + bad->evidence, where);
  if (out.safety.stopped())
    return fail(
        ErrorCode::safety,
        fmt::format("the record was stopped at {:.1f} s: {}", out.safety.t_s, to_string(out.safety.reason)),
        where);
  return out;
}

StimulusSpec sine(double f_Hz, double A_N, double m_N, double duration_s) {
  return {"sine", {{"f_Hz", f_Hz}, {"A_N", A_N}, {"m_N", m_N}, {"duration_s", duration_s}}, {}, {}, 1};
}

StimulusSpec rest(double level_N, double duration_s) {
  return {"rest", {{"level_N", level_N}, {"duration_s", duration_s}}, {}, {}, 1};
}

StimulusSpec sum_of_sines(std::vector<double> f_Hz, std::vector<double> A_N, double m_N, double duration_s) {
  return {"multisine",
          {{"m_N", m_N}, {"duration_s", duration_s}},
          {{"f_Hz", std::move(f_Hz)}, {"A_N", std::move(A_N)}},
          {},
          1};
}

}  // namespace forcegate::characterize
