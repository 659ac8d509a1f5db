#include "hil/gate/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/digest.h"
#include "hil/gate/prelude.h"
#include "hil/gate/sinks.h"
#include "hil/rig/safety_gate.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kPeriodsPerBlock = 409;
constexpr std::size_t kReplayBlock = 4096;
constexpr std::size_t kOverviewColumns = 200;
constexpr std::size_t kWindowRows = 2000;
constexpr double kWindowCycles = 5.0;

class CaseRun {
 public:
  CaseRun(const CaseJob& job, const RunDevices& devices)
      : job_(job), devices_(devices), gate_(*devices.rig, job.safety) {}

  CaseRecord run() {
    record_.id = job_.id;
    record_.index = job_.index;
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
    auto stimulus = make_stimulus(job_.planned.stimulus);
    if (!stimulus) return failed(Stage::setup, stimulus.error());
    stimulus_ = std::move(*stimulus);
    record_.facts = stimulus_->facts();
    record_.duration_s = stimulus_->duration_s();

    RigRecordRequest request;
    request.specimen = job_.specimen;
    request.seed = job_.seed;
    request.session = job_.session;
    request.record = job_.record + kRecordsPerAttempt * static_cast<std::uint64_t>(job_.attempt - 1);
    request.rest_before_s = job_.planned.rest_before_s;
    request.duration_s = record_.duration_s;
    request.force_low_N = record_.facts.minimum_N;
    request.force_high_N = record_.facts.maximum_N;
    request.faults = job_.faults;
    if (auto begun = gate_.begin(request); !begun) return failed(Stage::rig, begun.error());
    record_.rig = devices_.rig->info();
    const double rate_Hz = record_.rig.rate_Hz;
    record_.expected_samples = static_cast<std::uint64_t>(std::llround(record_.duration_s * rate_Hz));

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

    DutSession session;
    session.image = job_.image;
    session.nonce = job_.nonce;
    session.rate_Hz = rate_Hz;
    session.calibration = job_.calibration;
    auto opened = job_.planned.prelude_s > 0.0 ? play_prelude(*devices_.dut, devices_.comparator, session,
                                                              job_.planned.prelude_s, record_.prelude)
                                               : devices_.dut->open(session);
    if (!opened) return failed(Stage::firmware, opened.error());
    record_.firmware = *opened;
    dut_open_ = true;
    if (opened->nonce != job_.nonce)
      return failed(Stage::firmware, {ErrorCode::firmware,
                                      "the image did not echo the nonce of this record: stale output",
                                      job_.image,
                                      {}});

    if (devices_.comparator != nullptr) {
      ComparatorSession c{opened->algorithm_id, job_.calibration, rate_Hz};
      if (auto begun = devices_.comparator->begin(c); !begun) return failed(Stage::harness, begun.error());
      record_.conformance_known = true;
    }
    if (devices_.writer != nullptr)
      if (auto begun = devices_.writer->begin(job_, record_); !begun)
        return failed(Stage::harness, begun.error());

    period_samples_ =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::llround(kControlPeriod_s * rate_Hz)));
    block_rows_ = record_.rig.can_move ? period_samples_ * kPeriodsPerBlock : kReplayBlock;
    block_.resize(block_rows_);
    dut_.resize(block_rows_);
    raw_.resize(block_rows_);
    flags_.resize(block_rows_);
    commanded_.resize(block_rows_);
    setpoint_.resize(block_rows_ + 1);

    const double start_s = record_.facts.excitation_start_s;
    prominence_N_ = prominence_of(job_.planned, record_.facts);
    witness_.begin(record_.rig);
    output_.begin(rate_Hz, start_s);
    hold_.begin(rate_Hz, start_s);
    lag_.begin(rate_Hz, start_s);
    overview_.begin(record_.expected_samples, kOverviewColumns);
    const double f_Hz = record_.facts.lowest_frequency_Hz;
    const double length_s = f_Hz > 0.0 ? std::clamp(kWindowCycles / f_Hz, 2.0, 120.0) : 20.0;
    window_.begin(rate_Hz, std::min(length_s, record_.duration_s), kWindowRows);
    ExtremaPairer::Options options;
    options.prominence = prominence_N_;
    options.followers = 3;
    options.half_width = static_cast<int>(std::lround(job_.planned.half_width_s * rate_Hz));
    pairer_ = std::make_unique<ExtremaPairer>(options);
    gain_per_code_ = job_.calibration.gain_N_per_V * record_.rig.v_range_V /
                     (static_cast<double>((1u << record_.rig.adc_bits) - 1u));
    return true;
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
    const std::size_t step = record_.rig.can_move ? period_samples_ : wanted;
    std::size_t rows = 0;
    while (rows < wanted) {
      float told = 0.0f;
      if (controller_) {
        ControllerInput in;
        in.t_s = static_cast<double>(first + rows) / record_.rig.rate_Hz;
        in.period_s = kControlPeriod_s;
        in.setpoint_N = setpoint_[rows];
        in.setpoint_next_N = setpoint_[std::min(rows + period_samples_, wanted)];
        in.estimate_N = estimate_N_;
        in.theta_rad = devices_.rig->theta_rad();
        auto velocity = gate_.command(controller_->velocity_rad_per_s(in));
        if (!velocity) return failed(Stage::rig, velocity.error()), 0;
        told = static_cast<float>(*velocity);
      }
      auto got = gate_.run(std::min(step, wanted - rows), block_, rows);
      if (!got) return failed(Stage::rig, got.error()), 0;
      if (*got == 0) break;
      std::fill_n(commanded_.begin() + static_cast<std::ptrdiff_t>(rows), *got, told);
      if (closed) {
        if (!feed(first + rows, rows, *got)) return 0;
        const float force_N = dut_[rows + *got - 1];
        estimate_N_ = force_N;
      }
      rows += *got;
      if (gate_.report().stopped()) break;
    }
    if (!closed && rows > 0 && !feed(first, 0, rows)) return 0;
    return rows;
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
    const double offset_N = job_.calibration.offset_N;
    for (std::size_t i = 0; i < n; ++i)
      raw_[i] = static_cast<float>(gain_per_code_ * block_.adc[i] + offset_N);
    RecordBlock b{&block_, {dut_.data(), n}, {flags_.data(), n}, {raw_.data(), n}, n};
    digest_.update(block_.adc.data(), n * sizeof(std::uint16_t));
    digest_.update(block_.force_ref_N.data(), n * sizeof(float));
    digest_.update(block_.theta_rad.data(), n * sizeof(float));
    digest_.update(block_.status.data(), n * sizeof(std::uint16_t));
    digest_.update(dut_.data(), n * sizeof(float));
    digest_.update(flags_.data(), n);
    witness_.push(block_, n, controller_ ? commanded_.data() : nullptr);
    output_.push(b);
    if (record_.rig.can_move && job_.planned.checks & kCheckHold) hold_.push(b);
    lag_.push(b);
    if (job_.curves) {
      overview_.push(b);
      window_.push(b);
    }
    const bool with_setpoint = std::isfinite(block_.setpoint_N[0]);
    guide_is_setpoint_ = guide_is_setpoint_ || with_setpoint;
    const float* followers[3] = {block_.force_ref_N.data(), dut_.data(), raw_.data()};
    const float* guide = with_setpoint ? block_.setpoint_N.data() : block_.force_ref_N.data();
    pairer_->push({block_.t_s.data(), n}, {guide, n}, {followers, 3});
    look_for_worst();
    if (record_.conformance_known)
      devices_.comparator->push({block_.adc.data(), n}, {dut_.data(), n}, {flags_.data(), n});
    if (devices_.writer != nullptr)
      if (auto written = devices_.writer->push(block_, {dut_.data(), n}, {flags_.data(), n}, n); !written)
        failed(Stage::harness, written.error());
  }

  // Keeps the cycles around the worst maximum so far. Only a clear worsening is worth the copy.
  void look_for_worst() {
    if (!job_.curves) return;
    const auto& pairs = pairer_->pairs();
    for (; seen_pairs_ < pairs.size(); ++seen_pairs_) {
      const PairedExtremum& p = pairs[seen_pairs_];
      if (p.turn != Turn::maximum || p.t_s < judged_from_s()) continue;
      const bool closed = job_.planned.loop == LoopMode::closed;
      const double expected = closed ? p.guide : p.value[0];
      const double actual = closed ? p.value[0] : p.value[1];
      const double error = std::fabs(actual - expected);
      if (!(error > 1.05 * worst_N_)) continue;
      worst_N_ = error;
      window_.snapshot();
      record_.window_reason = fmt::format("worst maximum, at {:.1f} s", p.t_s);
    }
  }

  double judged_from_s() const {
    return std::max(record_.facts.excitation_start_s, output_.finish().learning_end_s);
  }

  void measure() {
    pairer_->finish();
    look_for_worst();
    for (const PairedExtremum& p : pairer_->pairs())
      record_.pairs.push_back({p.turn == Turn::maximum, p.t_s, guide_is_setpoint_ ? p.guide : kNan,
                               p.value[0], p.value[1], p.value[2]});
    record_.expected_extrema =
        record_.rig.can_move ? expected_extrema(*stimulus_, prominence_N_, record_.rig.rate_Hz) : 0;
    record_.observed = witness_.finish();
    record_.safety = gate_.report();
    record_.output = output_.finish();
    record_.hold = hold_.finish();
    lag_.finish(record_.lag_s, record_.u_lag_s);
    if (job_.curves) {
      record_.overview = overview_.finish();
      if (!window_.has_snapshot()) record_.window_reason = "end of the record";
      record_.window = window_.finish();
    }
    record_.digest = digest_.hex();
    if (record_.conformance_known) {
      const Comparison c = devices_.comparator->finish();
      record_.conformance = c.value;
      record_.conformance_limit = c.limit;
      record_.conformance_unit = c.unit;
      record_.conformance_source = c.limit_source;
      record_.conformance_evidence = c.evidence;
      record_.conformance_n = c.n;
    }
    if (devices_.writer != nullptr)
      if (auto written = devices_.writer->finish(); !written) failed(Stage::harness, written.error());
  }

  const CaseJob& job_;
  const RunDevices& devices_;
  SafetyGate gate_;
  CaseRecord record_;
  std::unique_ptr<Stimulus> stimulus_;
  std::unique_ptr<Controller> controller_;
  bool dut_open_ = false, guide_is_setpoint_ = false;
  std::size_t period_samples_ = 10, block_rows_ = 4090;
  RigBlock block_;
  std::vector<float> dut_, raw_, commanded_;
  std::vector<std::uint8_t> flags_;
  std::vector<double> setpoint_;
  double estimate_N_ = 0.0, gain_per_code_ = 0.0, prominence_N_ = 0.1, worst_N_ = 0.0;
  std::size_t seen_pairs_ = 0;
  RigWitness witness_;
  OutputWatch output_;
  HoldWatch hold_;
  LagEstimator lag_;
  Overview overview_;
  WindowKeeper window_;
  std::unique_ptr<ExtremaPairer> pairer_;
  Sha256 digest_;
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
