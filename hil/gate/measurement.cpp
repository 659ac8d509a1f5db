#include "hil/gate/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/gate/runner.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kOverviewColumns = 200;
constexpr std::size_t kWindowRows = 2000;
constexpr double kWindowCycles = 5.0;
constexpr double kBeginning_s = 3.0;

ExtremaPairer::Options pairer_options(const CaseJob& job, const CaseRecord& record) {
  ExtremaPairer::Options options;
  options.prominence = prominence_of(job.planned, record.facts);
  options.followers = 3;
  options.half_width = static_cast<int>(std::lround(job.planned.half_width_s * record.rig.rate_Hz));
  return options;
}

}  // namespace

RecordMeasurement::RecordMeasurement(const CaseJob& job, CaseRecord& record, Comparator* comparator,
                                     std::size_t block_rows)
    : job_(job),
      record_(record),
      comparator_(comparator),
      raw_(block_rows),
      pairer_(pairer_options(job, record)) {
  const double rate_Hz = record.rig.rate_Hz, start_s = record.facts.excitation_start_s;
  prominence_N_ = prominence_of(job.planned, record.facts);
  witness_.begin(record.rig);
  output_.begin(rate_Hz, start_s);
  hold_.begin(rate_Hz, start_s);
  // One clock drives all of an emulated rig: nothing to compare.
  lag_.begin(rate_Hz, start_s,
             record.rig.emulated ? std::numeric_limits<double>::infinity() : record.duration_s);
  waveform_.begin(record.facts, record.duration_s, rate_Hz);
  overview_.begin(record.expected_samples, kOverviewColumns);
  const double f_Hz = record.facts.lowest_frequency_Hz;
  const double length_s = f_Hz > 0.0 ? std::clamp(kWindowCycles / f_Hz, 2.0, 120.0) : 20.0;
  window_.begin(rate_Hz, std::min(length_s, record.duration_s), kWindowRows, block_rows);
  gain_per_code_ = job.calibration.gain_N_per_V * record.rig.v_range_V /
                   (static_cast<double>((1u << record.rig.adc_bits) - 1u));
}

void RecordMeasurement::push(const RigBlock& block, std::span<const float> dut_N,
                             std::span<const std::uint8_t> flags, const float* commanded_rad_per_s,
                             std::size_t n) {
  const double offset_N = job_.calibration.offset_N;
  for (std::size_t i = 0; i < n; ++i) raw_[i] = static_cast<float>(gain_per_code_ * block.adc[i] + offset_N);
  const RecordBlock b{&block, dut_N, flags, {raw_.data(), n}, n};
  digest_.update(block.adc.data(), n * sizeof(std::uint16_t));
  digest_.update(block.force_ref_N.data(), n * sizeof(float));
  digest_.update(block.theta_rad.data(), n * sizeof(float));
  digest_.update(block.status.data(), n * sizeof(std::uint16_t));
  digest_.update(dut_N.data(), n * sizeof(float));
  digest_.update(flags.data(), n);
  witness_.push(block, n, commanded_rad_per_s);
  output_.push(b);
  if (job_.planned.checks & kCheckHold) hold_.push(b);
  lag_.push(b);
  waveform_.push(block, dut_N.data(), n);
  if (block.t_s[0] < kBeginning_s) look_at_beginning(block, n);
  if (job_.curves) {
    overview_.push(b);
    window_.push(b);
  }
  const bool with_setpoint = std::isfinite(block.setpoint_N[0]);
  guide_is_setpoint_ = guide_is_setpoint_ || with_setpoint;
  const float* followers[3] = {block.force_ref_N.data(), dut_N.data(), raw_.data()};
  const float* guide = with_setpoint ? block.setpoint_N.data() : block.force_ref_N.data();
  pairer_.push({block.t_s.data(), n}, {guide, n}, {followers, 3});
  look_for_worst();
  if (comparator_ != nullptr) comparator_->push({block.adc.data(), n}, dut_N, flags);
}

void RecordMeasurement::look_at_beginning(const RigBlock& block, std::size_t n) {
  const auto last_code = static_cast<std::uint16_t>((1u << record_.rig.adc_bits) - 1u);
  for (std::size_t i = 0; i < n && block.t_s[i] < kBeginning_s; ++i) {
    if (block.adc[i] == 0 || block.adc[i] == last_code || !std::isfinite(block.force_ref_N[i])) continue;
    early_n_ += 1.0;
    early_raw_ += raw_[i];
    early_ati_ += block.force_ref_N[i];
  }
}

// Keeps the cycles around the worst maximum so far: a pair is known up to a block after its instant. Only a clear worsening is worth the copy.
void RecordMeasurement::look_for_worst() {
  if (!job_.curves) return;
  const double from_s = std::max(record_.facts.excitation_start_s, output_.finish().learning_end_s);
  const auto& pairs = pairer_.pairs();
  for (; seen_pairs_ < pairs.size(); ++seen_pairs_) {
    const PairedExtremum& p = pairs[seen_pairs_];
    if (p.turn != Turn::maximum || p.t_s < from_s) continue;
    const bool closed = job_.planned.loop == LoopMode::closed;
    const double expected = closed ? p.guide : p.value[0];
    const double actual = closed ? p.value[0] : p.value[1];
    const double error = std::fabs(actual - expected);
    if (!(error > 1.05 * worst_N_)) continue;
    worst_N_ = error;
    window_.around(p.t_s);
    record_.window_reason = fmt::format("worst maximum, at {:.1f} s", p.t_s);
  }
}

void RecordMeasurement::finish(const Stimulus& stimulus) {
  pairer_.finish();
  look_for_worst();
  for (const PairedExtremum& p : pairer_.pairs())
    record_.pairs.push_back({p.turn == Turn::maximum, p.t_s, guide_is_setpoint_ ? p.guide : kNan, p.value[0],
                             p.value[1], p.value[2]});
  record_.expected_extrema =
      record_.rig.can_move ? expected_extrema(stimulus, prominence_N_, record_.rig.rate_Hz) : 0;
  record_.observed = witness_.finish();
  record_.output = output_.finish();
  record_.hold = hold_.finish();
  record_.waveform = waveform_.finish();
  lag_.finish(record_.lag_s, record_.u_lag_s);
  record_.raw_lag_s = lag_.raw_lag_s();
  if (const LagDrift d = lag_.drift(); std::isfinite(d.drift_ppm))
    record_.rig.details["sensor behind reference"] = fmt::format(
        "{:.2f} ms in the first half of the record, {:.2f} ms in the second: {:+.1f} ppm, u = {:.1f} ppm",
        1e3 * d.first_lag_s, 1e3 * d.second_lag_s, d.drift_ppm, d.u_drift_ppm);
  if (job_.curves) {
    record_.overview = overview_.finish();
    if (!window_.has_any()) record_.window_reason = "end of the record";
    record_.window = window_.finish();
  }
  record_.early_raw_N = early_n_ > 0.0 ? early_raw_ / early_n_ : kNan;
  record_.early_ati_N = early_n_ > 0.0 ? early_ati_ / early_n_ : kNan;
  record_.digest = digest_.hex();
  if (comparator_ == nullptr) return;
  const Comparison c = comparator_->finish();
  record_.conformance = c.value;
  record_.conformance_limit = c.limit;
  record_.conformance_unit = c.unit;
  record_.conformance_source = c.limit_source;
  record_.conformance_evidence = c.evidence;
  record_.conformance_n = c.n;
}

}  // namespace forcegate
