#pragma once
// Plays one record: Stimulus -> Rig{ Controller -> SafetyGate } -> firmware -> sinks. It measures and judges
// nothing. Open loop: the firmware gets whole blocks. Closed loop: the firmware gets the samples of one
// controller period (hil/rig/control_period.h) and its last force is the controller's estimate.

#include <atomic>
#include <functional>
#include <memory>

#include "hil/gate/case_record.h"
#include "hil/interface/comparator.h"
#include "hil/interface/controller.h"
#include "hil/interface/dut.h"
#include "hil/interface/rig.h"

namespace forcegate {

/// Takes the samples of a record as they come (journal). Errors end the record as harness failures.
class RecordWriter {
 public:
  virtual ~RecordWriter() = default;
  virtual Result<void> begin(const CaseJob& job, const CaseRecord& so_far) = 0;
  /// Rows [from, from + n) of the block and of the columns beside it. commanded: wheel velocity told for each row, null
  /// where there is none.
  virtual Result<void> push(const RigBlock& block, std::span<const float> dut_N,
                            std::span<const std::uint8_t> flags, const float* commanded_rad_per_s,
                            std::size_t from, std::size_t n) = 0;
  virtual Result<void> finish() = 0;
};

struct RunDevices {
  Rig* rig = nullptr;
  Dut* dut = nullptr;                        ///< sees every sample
  Comparator* comparator = nullptr;          ///< may be null
  RecordWriter* writer = nullptr;            ///< may be null
  std::function<void(double t_s)> progress;  ///< about once per four seconds of rig time
  const std::atomic<bool>* cancelled = nullptr;
};

/// Never fails: what went wrong is in CaseRecord::failure with the stage that it belongs to.
CaseRecord run_case(const CaseJob& job, const RunDevices& devices);

/// Turning points that the profile itself has, found by the same detector (ramp-in excluded).
std::uint64_t expected_extrema(const Stimulus& stimulus, double prominence_N, double rate_Hz);

/// Prominence of the detector for a case: the plan's or a quarter of the amplitude, at least 0.05 N.
double prominence_of(const PlanCase& planned, const StimulusFacts& facts);

/// Instant from which extrema count: ramp-in and start window are over, or the last tail_s of the record.
double judged_from_s(const PlanCase& planned, const CaseRecord& record);

}  // namespace forcegate
