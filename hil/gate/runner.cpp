#include "hil/gate/runner.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/gate/board_faults.h"
#include "hil/gate/measurement.h"
#include "hil/gate/prelude.h"
#include "hil/gate/settled_rows.h"
#include "hil/interface/firmware_guard.h"
#include "hil/rig/control_period.h"
#include "hil/rig/safety_gate.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr std::size_t kPeriodsPerBlock = 409;
constexpr std::size_t kReplayBlock = 4096;

class CaseRun {
 public:
  CaseRun(const CaseJob& job, const RunDevices& devices)
      : job_(job), devices_(devices), gate_(*devices.rig, job.safety) {}

  CaseRecord run() {
    record_.id = job_.id;
    record_.index = job_.index;
    record_.calibration = job_.calibration;
    record_.calibration_given = job_.calibration_given;
    if (setup()) {
      stream();
      measure();
    }
    return std::move(record_);
  }

 private:
  using Stage = CaseFailure::Stage;

  bool failed(Stage stage, Error error) {
    if (!record_.failure) record_.failure = CaseFailure{stage, std::move(error)};
    return false;
  }

  bool setup() {
    if (!(make_profile() && begin_rig() && choose_controller() && open_firmware() && begin_comparator() && begin_writer())) return false;
    prepare_blocks();
    return true;
  }

  bool make_profile() {
    auto stimulus = make_stimulus(job_.planned.stimulus);
    if (!stimulus) return failed(Stage::setup, stimulus.error());
    stimulus_ = std::move(*stimulus);
    record_.facts = stimulus_->facts();
    record_.duration_s = stimulus_->duration_s();
    return true;
  }

  bool begin_rig() {
    RigRecordRequest request;
    request.specimen = job_.specimen;
    request.seed = job_.seed;
    request.session = job_.session;
    request.record = job_.record + kRecordsPerAttempt * static_cast<std::uint64_t>(job_.attempt - 1);
    request.rest_before_s = job_.planned.rest_before_s;
    request.duration_s = record_.duration_s;
    request.force_low_N = record_.facts.minimum_N;
    request.force_high_N = record_.facts.maximum_N;
    request.faults = rig_faults(job_.faults);
    if (auto begun = gate_.begin(request); !begun) return failed(Stage::rig, begun.error());
    record_.rig = devices_.rig->info();
    record_.expected_samples = static_cast<std::uint64_t>(std::llround(record_.duration_s * record_.rig.rate_Hz));
    return true;
  }

  bool choose_controller() {
    if (record_.rig.can_move) {
      const ControllerKind* kind = Registry<ControllerKind>::instance().find(job_.planned.controller);
      if (kind == nullptr)
        return failed(Stage::setup,
                      {ErrorCode::config, "there is no controller named '" + job_.planned.controller + "'",
                       job_.planned.where, "choose open_loop or force_integral"});
      controller_ = kind->make();
      controller_->reset(record_.rig.geometry);
    } else if (job_.planned.loop == LoopMode::closed) {
      return failed(Stage::setup, {ErrorCode::config, "a recording cannot play a closed loop",
                                   job_.planned.where, "use an open-loop plan with --rig replay"});
    }
    return true;
  }

  bool open_firmware() {
    DutSession session;
    session.image = job_.image;
    session.nonce = job_.nonce;
    session.rate_Hz = record_.rig.rate_Hz;
    session.calibration = job_.calibration;
    auto opened = job_.planned.prelude_s > 0.0 ? play_prelude(*devices_.dut, devices_.comparator, session,
                                                              job_.planned.prelude_s, record_.prelude)
                                               : devices_.dut->open(session);
    if (!opened) return failed_to_open(opened.error());
    record_.firmware = *opened;
    tell_guard(g_firmware_guard.load(std::memory_order_relaxed), *opened);
    dut_open_ = true;
    if (opened->nonce != job_.nonce)
      return failed(Stage::firmware, {ErrorCode::firmware,
                                      "the image did not echo the nonce of this record: stale output",
                                      job_.image,
                                      {}});
    return true;
  }

  // A recording has the rate that somebody recorded it at, an option the one that was typed; else a rig has its own, and
  // the image must keep it.
  bool failed_to_open(Error error) {
    const bool given = !record_.rig.can_move || job_.rig_options.contains("rate_Hz");
    const bool is_rate = error.code == ErrorCode::config;
    const Stage stage = error.code == ErrorCode::usage || (given && is_rate) ? Stage::setup : Stage::firmware;
    if (!given && is_rate) error.code = ErrorCode::firmware;
    return failed(stage, std::move(error));
  }

  bool begin_comparator() {
    if (devices_.comparator == nullptr) return true;
    const ComparatorSession session{record_.firmware.algorithm_id, job_.calibration, record_.rig.rate_Hz};
    if (auto begun = devices_.comparator->begin(session); !begun) {
      if (begun.error().code != ErrorCode::config) return failed(Stage::harness, begun.error());
      return failed(Stage::firmware, {ErrorCode::firmware, "the image declares an algorithm that is not what it runs: " + begun.error().text, job_.image,
                                      "declare an id of its own (docs/protocol.md)"});
    }
    record_.conformance_known = true;
    return true;
  }

  bool begin_writer() {
    if (devices_.writer == nullptr) return true;
    auto begun = devices_.writer->begin(job_, record_);
    return begun ? true : failed(Stage::harness, begun.error());
  }

  void prepare_blocks() {
    const double rate_Hz = record_.rig.rate_Hz;
    period_ = control_period(rate_Hz);
    on_board_ = devices_.rig->board_firmware() != nullptr;
    settled_ = SettledRows(rate_Hz);
    block_rows_ = record_.rig.can_move ? period_.samples * kPeriodsPerBlock : kReplayBlock;
    block_.resize(block_rows_);
    dut_.resize(block_rows_);
    flags_.resize(block_rows_);
    commanded_.resize(block_rows_);
    setpoint_.resize(block_rows_ + 1);

    measurement_.emplace(job_, record_, record_.conformance_known ? devices_.comparator : nullptr,
                         block_rows_);
    measurement_->zero_before(devices_.rig->reference_zero());
  }

  // Set-points of the rows [at, at + n] of the block that begins at sample `first`.
  void fill_setpoints(std::uint64_t first, std::size_t n) {
    if (!record_.rig.can_move) return;
    const double step_s = 1.0 / record_.rig.rate_Hz;
    const double t_s = static_cast<double>(first) * step_s;
    stimulus_->fill(t_s, step_s, n, setpoint_.data());
    setpoint_[n] = stimulus_->force_N(std::min(t_s + static_cast<double>(n) * step_s, record_.duration_s));
    for (std::size_t i = 0; i < n; ++i) block_.setpoint_N[i] = static_cast<float>(setpoint_[i]);
  }

  // One block into block_ and dut_; the number of rows, 0 at the end or after a failure.
  std::size_t next_block(std::uint64_t first) {
    const std::size_t wanted =
        static_cast<std::size_t>(std::min<std::uint64_t>(block_rows_, record_.expected_samples - first));
    if (wanted == 0) return 0;
    fill_setpoints(first, wanted);
    const bool closed = job_.planned.loop == LoopMode::closed;
    const std::size_t step = record_.rig.can_move ? period_.samples : wanted;
    std::size_t rows = 0;
    answered_ = 0;
    while (rows < wanted) {
      float told = 0.0f;
      if (controller_) {
        ControllerInput in;
        in.t_s = static_cast<double>(first + rows) / record_.rig.rate_Hz;
        in.period_s = period_.s;
        in.setpoint_N = setpoint_[rows];
        in.setpoint_next_N = setpoint_[std::min(rows + period_.samples, wanted)];
        in.estimate_N = estimate_N_;
        in.theta_rad = devices_.rig->theta_rad();
        auto velocity = gate_.command(controller_->velocity_rad_per_s(in));
        if (!velocity) return failed(Stage::rig, velocity.error()), 0;
        told = static_cast<float>(*velocity);
      }
      auto got = gate_.run(std::min(step, wanted - rows), block_, rows);
      if (!got) {
        failed(Stage::rig, got.error());
        record_.failure->sample = first + rows;
        return 0;
      }
      if (*got == 0) break;
      std::fill_n(commanded_.begin() + static_cast<std::ptrdiff_t>(rows), *got, told);
      if (closed || on_board_) {
        if (!feed(first + rows, rows, *got)) return 0;
        const float force_N = dut_[rows + *got - 1];
        estimate_N_ = force_N;
      }
      rows += *got;
      if (closed || on_board_) answered_ = rows;
      if (on_board_ && !save(settled_.due(rows))) return 0;
      if (gate_.report().stopped()) break;
    }
    if (!closed && !on_board_ && rows > 0 && !feed(first, 0, rows)) return 0;
    return rows;
  }

  // Rows of the block up to `end` into the recording.
  bool save(std::size_t end) {
    const std::size_t from = settled_.saved();
    if (devices_.writer == nullptr || end <= from) return true;
    auto written = devices_.writer->push(block_, dut_, flags_, controller_ ? commanded_.data() : nullptr,
                                         from, end - from);
    settled_.save_until(end);
    return written ? true : failed(Stage::harness, written.error());
  }

  bool feed(std::uint64_t index, std::size_t at, std::size_t n) {
    auto fed = devices_.dut->process(static_cast<std::uint32_t>(index), {block_.adc.data() + at, n},
                                     {dut_.data() + at, n}, {flags_.data() + at, n});
    return fed ? true : failed(Stage::firmware, fed.error());
  }

  void stream() {
    std::uint64_t done = 0;
    while (done < record_.expected_samples && !record_.failure) {
      const std::size_t rows = next_block(done);
      if (record_.failure) save(answered_);
      if (rows == 0) break;
      consume(rows);
      done += rows;
      if (devices_.progress) devices_.progress(block_.t_s[rows - 1]);
      if (gate_.report().stopped()) break;
      if (devices_.cancelled != nullptr && devices_.cancelled->load(std::memory_order_relaxed)) {
        failed(Stage::setup, {ErrorCode::cancelled, "interrupted", job_.id, {}});
        break;
      }
    }
    record_.samples = done;
    devices_.rig->park();
    record_.rig.details = devices_.rig->info().details;  // with what the instruments counted
    measurement_->zero_after(devices_.rig->reference_zero());
    if (dut_open_) {
      auto closed = devices_.dut->close();
      record_.resources = devices_.dut->resources();
      if (closed)
        record_.link = *closed;
      else
        failed(Stage::firmware, closed.error());
    }
  }

  void consume(std::size_t n) {
    measurement_->push(block_, {dut_.data(), n}, {flags_.data(), n},
                       controller_ ? commanded_.data() : nullptr, n);
    save(n);
    settled_.next_block();
  }

  void measure() {
    measurement_->finish(*stimulus_);
    record_.safety = gate_.report();
    if (devices_.writer != nullptr)
      if (auto written = devices_.writer->finish(); !written) failed(Stage::harness, written.error());
  }

  const CaseJob& job_;
  const RunDevices& devices_;
  SafetyGate gate_;
  CaseRecord record_;
  std::unique_ptr<Stimulus> stimulus_;
  std::unique_ptr<Controller> controller_;
  bool dut_open_ = false;
  bool on_board_ = false;  ///< the firmware runs behind the rig's own wires
  std::size_t answered_ = 0;  ///< rows of the block that rig and firmware have both made, kept when the rest fails
  SettledRows settled_;
  ControlPeriod period_;
  std::size_t block_rows_ = 4090;
  RigBlock block_;
  std::vector<float> dut_, commanded_;
  std::vector<std::uint8_t> flags_;
  std::vector<double> setpoint_;
  double estimate_N_ = 0.0;
  std::optional<RecordMeasurement> measurement_;
};

}  // namespace

double prominence_of(const PlanCase& planned, const StimulusFacts& facts) {
  if (planned.prominence_N > 0.0) return planned.prominence_N;
  return std::max(0.05, 0.25 * (std::isfinite(facts.amplitude_N) ? facts.amplitude_N : 0.0));
}

std::uint64_t expected_extrema(const Stimulus& stimulus, double prominence_N, double rate_Hz) {
  TurningPoints turns(prominence_N);
  constexpr std::size_t kChunk = 1024;
  double force_N[kChunk];
  const double step_s = 10.0 / rate_Hz;
  const double start_s = stimulus.facts().excitation_start_s;
  const auto total = static_cast<std::uint64_t>(stimulus.duration_s() / step_s);
  std::uint64_t count = 0;
  for (std::uint64_t first = 0; first < total; first += kChunk) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(kChunk, total - first));
    stimulus.fill(static_cast<double>(first) * step_s, step_s, n, force_N);
    for (std::size_t i = 0; i < n; ++i)
      if (turns.push(static_cast<double>(first + i) * step_s, force_N[i]) && turns.last().t_s >= start_s)
        ++count;
  }
  return count;
}

double judged_from_s(const PlanCase& planned, const CaseRecord& record) {
  double from_s = std::max(record.facts.excitation_start_s, record.output.learning_end_s);
  if (planned.tail_s > 0.0) from_s = std::max(from_s, record.duration_s - planned.tail_s);
  return from_s;
}

CaseRecord run_case(const CaseJob& job, const RunDevices& devices) { return CaseRun(job, devices).run(); }

}  // namespace forcegate
