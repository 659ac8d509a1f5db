#pragma once
// What is measured in a record while its samples stream past, live or from a recording: extrema, lag, output, hold, rig
// witness, conformance, digest, curves. The same samples give the same facts.

#include <memory>
#include <span>
#include <vector>

#include "hil/base/digest.h"
#include "hil/gate/case_record.h"
#include "hil/gate/sinks.h"
#include "hil/gate/waveform.h"
#include "hil/interface/comparator.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/rig_witness.h"
#include "hil/trace/extrema.h"

namespace forcegate {

class RecordMeasurement {
 public:
  /// `record` holds rig, facts, duration_s and expected_samples; the comparator has been begun (may be null). Both and
  /// the job must outlive the measurement. No allocation of a record's length.
  RecordMeasurement(const CaseJob& job, CaseRecord& record, Comparator* comparator, std::size_t block_rows);

  /// Unloaded readings of the reference before the first and after the last sample.
  void zero_before(const ReferenceZero& zero) { witness_.zero_before(zero); }
  void zero_after(const ReferenceZero& zero) { witness_.zero_after(zero); }

  /// The first n rows; commanded: velocity the rig was told for each of them, null where it has no wheel.
  void push(const RigBlock& block, std::span<const float> dut_N, std::span<const std::uint8_t> flags,
            const float* commanded_rad_per_s, std::size_t n);

  /// Fills everything of the record that comes from its samples. The stimulus gives the number of extrema that the
  /// profile has.
  void finish(const Stimulus& stimulus);

 private:
  void look_for_worst();
  void look_at_beginning(const RigBlock& block, std::size_t n);

  const CaseJob& job_;
  CaseRecord& record_;
  Comparator* comparator_;
  bool guide_is_setpoint_ = false;
  double gain_per_code_ = 0.0, prominence_N_ = 0.1, worst_N_ = 0.0;
  double early_n_ = 0.0, early_raw_ = 0.0, early_ati_ = 0.0;
  std::size_t seen_pairs_ = 0;
  std::vector<float> raw_;
  RigWitness witness_;
  OutputWatch output_;
  HoldWatch hold_;
  LagEstimator lag_;
  Overview overview_;
  WindowKeeper window_;
  WaveformKeeper waveform_;
  ExtremaPairer pairer_;
  SampleDigest digest_;
};

}  // namespace forcegate
