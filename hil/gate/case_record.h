#pragma once
// One record to be made, and what was measured in it. Both cross the pipe between the gate and its worker.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/gate/plan.h"
#include "hil/gate/waveform.h"
#include "hil/interface/dut.h"
#include "hil/interface/rig.h"
#include "hil/interface/run_result.h"
#include "hil/rig/rig_observation.h"
#include "hil/rig/safety_gate.h"

namespace forcegate {

/// Distance between the record numbers of two attempts: above those of all cases and calibrations.
inline constexpr std::uint64_t kRecordsPerAttempt = 10000000;

/// Everything a worker needs; no reference to the plan is left in it.
struct CaseJob {
  enum class Kind { record, calibration } kind = Kind::record;
  std::string id;  ///< "sine_f0.50/q50"
  std::uint64_t index = 0;
  std::string rig;  ///< registry name
  std::map<std::string, std::string> rig_options;
  std::string lane;
  std::map<std::string, std::string> lane_options;
  std::string image;
  std::uint32_t nonce = 0;
  PlanCase planned;
  std::string specimen;
  std::uint64_t seed = 1, session = 0, record = 0;
  int attempt = 1;  ///< above 1 after rig errors; the emulated rig draws its noise anew
  Calibration calibration;
  bool calibration_given = false;  ///< of a file, or nominal values: not measured in this run
  PlanCalibration calibrate;  ///< for Kind::calibration
  SafetyLimits safety;
  std::map<std::string, double> faults;
  std::string keep_path;  ///< samples are written there (in a bundle: relative to the run); "" = not kept
  bool curves = true;     ///< overview and window are collected
};

/// Where a record broke off.
struct CaseFailure {
  enum class Stage { setup, rig, firmware, harness } stage = Stage::harness;
  Error error;
  Blame blame = Blame::none;  ///< none: follows from stage and code
  std::uint64_t sample = 0;   ///< of the record, at which the rig gave no more
};

struct CasePair {
  bool maximum = true;
  double t_s = 0.0;
  double setpoint_N = 0.0, ati_N = 0.0, dut_N = 0.0, raw_N = 0.0;  ///< NaN where a channel has none
};

/// What the firmware's output looked like.
struct OutputFacts {
  std::uint64_t not_finite = 0;
  double first_not_finite_s = 0.0;
  double minimum_N = 0.0, maximum_N = 0.0;
  double learning_longest_s = 0.0;  ///< longest episode with the flag
  double learning_end_s = 0.0;      ///< end of the first episode after the excitation began
  std::uint64_t held = 0, input_rail = 0, clamped = 0;
  double departure_N = 0.0;  ///< mean |F_dut - ATI| over about the last 0.2 s of the record
  /// Largest excursion of one sample beyond those 10 ms before and after it while the code has none; NaN below 500 Hz.
  double spike_N = 0.0, spike_t_s = 0.0;
};

/// Static hold after cycling: means over the part of the hold that follows its first 30 s.
struct HoldFacts {
  double seconds = 0.0;
  double dut_N = 0.0, raw_N = 0.0, ati_N = 0.0;
};

/// What the image did before its RESET, in a session with another calibration and codes that no rig makes.
struct PreludeFacts {
  std::uint64_t samples = 0;  ///< 0: none was played
  std::uint64_t not_finite = 0;
  double largest_N = 0.0;
  bool conformance_known = false;
  double conformance = 0.0, conformance_limit = 0.0;
  std::string conformance_unit, conformance_source, conformance_evidence;
};

struct CaseRecord {
  std::string id;
  std::uint64_t index = 0;
  std::optional<CaseFailure> failure;
  RigInfo rig;
  DutInfo firmware;
  DutCounters link;
  DutResources resources;
  PreludeFacts prelude;
  StimulusFacts facts;
  double duration_s = 0.0;
  std::uint64_t samples = 0, expected_samples = 0;
  std::uint64_t expected_extrema = 0;  ///< of the profile, by the same detector
  RigObservation observed;
  SafetyReport safety;
  OutputFacts output;
  HoldFacts hold;
  std::vector<CasePair> pairs;
  double lag_s = 0.0, u_lag_s = 0.0;  ///< firmware behind ATI; NaN when the record does not determine it
  double raw_lag_s = 0.0;             ///< raw sensor force behind ATI; NaN when not determined
  double early_raw_N = 0.0,
         early_ati_N = 0.0;        ///< means over the first 3 s off the converter's rails; NaN without any
  bool conformance_known = false;  ///< an oracle for the declared algorithm exists
  double conformance = 0.0, conformance_limit = 0.0;
  std::string conformance_unit, conformance_source, conformance_evidence;
  std::uint64_t conformance_n = 0;
  std::vector<RecordWindow> waveform;  ///< begin, middle, end; for goldens
  std::vector<PlotTrace> overview, window;
  std::string window_reason;
  DecayFit decay;
  std::string digest;
  std::string trace_file;
  Calibration calibration;  ///< told to the firmware; Kind::calibration: measured
  bool calibration_given = false;
  // Kind::calibration only:
  double u_gain_rel = 0.0, u_offset_N = 0.0;
  double calibration_rmse_N = 0.0;
  std::string calibration_text;
};

}  // namespace forcegate
