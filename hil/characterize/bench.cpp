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

RigRecordRequest request_of(const Bench::Setup& setup, std::uint64_t record, const Stimulus& stimulus, const Closed& closed) {
  const StimulusFacts facts = stimulus.facts();
  RigRecordRequest request;
  request.faults = closed.faults;
  request.specimen = setup.specimen;
  request.seed = setup.seed;
  request.session = setup.session;
  request.record = record;
  request.rest_before_s = setup.rest_s;
  request.duration_s = stimulus.duration_s();
  request.force_low_N = facts.minimum_N;
  request.force_high_N = facts.maximum_N;
  return request;
}

Result<std::unique_ptr<Controller>> controller_of(const Closed& closed, const RigGeometry& geometry) {
  const std::string name = closed.estimator ? closed.controller : "open_loop";
  const ControllerKind* kind = Registry<ControllerKind>::instance().find(name);
  if (kind == nullptr) return fail(ErrorCode::internal, "the controller '" + name + "' is not linked");
  auto controller = kind->make();
  controller->reset(geometry);
  return controller;
}

// One record on its way: blocks of the profile, row by row through controller, safety gate and estimator.
class Playing {
 public:
  Playing(Rig& rig, double rate_Hz, SafetyGate& gate, const Stimulus& stimulus, Controller& controller, const Estimator& estimator)
      : rig_(rig),
        gate_(gate),
        stimulus_(stimulus),
        controller_(controller),
        estimator_(estimator),
        rate_Hz_(rate_Hz),
        period_(control_period(rate_Hz)),
        duration_s_(stimulus.duration_s()),
        estimate_N_(stimulus.facts().minimum_N) {
    block_.resize(period_.samples * kPeriodsPerBlock);
    setpoint_N_.resize(block_.size() + 1);
    commanded_.resize(block_.size());
    estimates_.resize(estimator_ ? block_.size() : 0);
  }

  std::uint64_t total() const { return static_cast<std::uint64_t>(std::llround(duration_s_ * rate_Hz_)); }

  // Rows of the next block, 0 when the rig has no more.
  Result<std::size_t> next_block(std::uint64_t first) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(block_.size(), total() - first));
    fill_setpoints(first, wanted);
    std::size_t rows = 0;
    while (rows < wanted) {
      FORCEGATE_TRY(const double told, gate_.command(controller_.velocity_rad_per_s(input_at(first, rows, wanted))));
      FORCEGATE_TRY(const std::size_t got, gate_.run(std::min(period_.samples, wanted - rows), block_, rows));
      if (got == 0) break;
      take(rows, got, told);
      rows += got;
    }
    return rows;
  }

  const RigBlock& block() const { return block_; }
  const float* commanded() const { return commanded_.data(); }
  std::span<const float> estimates(std::size_t rows) const { return {estimates_.data(), estimator_ ? rows : 0}; }

 private:
  void fill_setpoints(std::uint64_t first, std::size_t wanted) {
    const double first_s = static_cast<double>(first) / rate_Hz_;
    stimulus_.fill(first_s, 1.0 / rate_Hz_, wanted, setpoint_N_.data());
    setpoint_N_[wanted] = stimulus_.force_N(std::min(static_cast<double>(first + wanted) / rate_Hz_, duration_s_));
  }

  ControllerInput input_at(std::uint64_t first, std::size_t row, std::size_t wanted) const {
    ControllerInput in;
    in.t_s = static_cast<double>(first + row) / rate_Hz_;
    in.period_s = period_.s;
    in.setpoint_N = setpoint_N_[row];
    in.setpoint_next_N = setpoint_N_[std::min(row + period_.samples, wanted)];
    in.estimate_N = estimate_N_;
    in.theta_rad = rig_.theta_rad();
    return in;
  }

  void take(std::size_t from, std::size_t n, double told) {
    for (std::size_t i = from; i < from + n; ++i) {
      block_.setpoint_N[i] = static_cast<float>(setpoint_N_[i]);
      commanded_[i] = static_cast<float>(told);
      if (!estimator_) continue;
      estimate_N_ = estimator_(block_.adc[i]);
      estimates_[i] = static_cast<float>(estimate_N_);
    }
  }

  Rig& rig_;
  SafetyGate& gate_;
  const Stimulus& stimulus_;
  Controller& controller_;
  const Estimator& estimator_;
  double rate_Hz_;
  ControlPeriod period_;
  double duration_s_, estimate_N_;
  RigBlock block_;
  std::vector<double> setpoint_N_;
  std::vector<float> commanded_, estimates_;
};

Result<void> check_open_loop(const PlayedRecord& played, const RigObservation& observed, const std::string& where) {
  const auto checks = self_check(played.rig, observed);
  if (const Check* bad = first_unsound(checks)) return fail(ErrorCode::device, bad->title + ": " + bad->evidence, where);
  if (played.safety.stopped())
    return fail(ErrorCode::safety,
                fmt::format("the record was stopped at {:.1f} s: {}", played.safety.t_s, to_string(played.safety.reason)), where);
  return {};
}

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
  const RigRecordRequest request = request_of(setup_, ++record_, stimulus, closed);
  SafetyGate gate(rig_, setup_.safety);
  FORCEGATE_CHECK_OK(gate.begin(request));
  PlayedRecord out;
  out.rig = rig_.info();
  FORCEGATE_TRY(const auto controller, controller_of(closed, out.rig.geometry));
  RigWitness witness;
  witness.begin(out.rig);
  Playing playing(rig_, out.rig.rate_Hz, gate, stimulus, *controller, closed.estimator);
  const std::uint64_t total = playing.total();
  while (out.samples < total && !gate.report().stopped()) {
    FORCEGATE_TRY(const std::size_t rows, playing.next_block(out.samples));
    if (rows == 0) break;
    witness.push(playing.block(), rows, playing.commanded());
    if (sink) sink(playing.block(), rows, playing.estimates(rows));
    out.samples += rows;
    progress_.samples += rows;
    if (progress_.is_cancelled()) return fail(ErrorCode::cancelled, "interrupted");
  }
  samples_ += out.samples;
  out.safety = gate.report();
  const std::string where =
      fmt::format("{}, session {}, record {}", request.specimen, request.session, request.record);
  if (!out.safety.stopped() && out.samples < total)
    return fail(ErrorCode::timeout, fmt::format("the record is truncated: {} of {} samples", out.samples, total), where);
  // what a loop that is closed over a poor estimate does to sensor and bench is what it is played for
  if (!closed.estimator) FORCEGATE_CHECK_OK(check_open_loop(out, witness.finish(), where));
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
