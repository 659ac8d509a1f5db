#pragma once
// The one versioned result of a gate run. Every view renders it and nothing else.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/calibration.h"
#include "hil/interface/check.h"
#include "hil/interface/dut.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"

namespace forcegate {

inline constexpr int kResultFormat = 1;

/// A decimated curve for pictures: first / min / max / last per pixel column of trace and error
/// united, so that no peak is lost. Never used for a number in a table.
struct PlotTrace {
  std::string name;  ///< "set-point", "ATI", "firmware", "raw"
  std::string unit;
  std::vector<float> t_s;
  std::vector<float> value;
};

/// Paired extrema of two channels; t is that of the first channel.
struct ExtremaSeries {
  std::string name;  ///< "maxima" or "minima"
  std::vector<float> t_s;
  std::vector<float> expected_N;  ///< open loop: ATI; closed loop: set-point
  std::vector<float> actual_N;    ///< open loop: firmware; closed loop: ATI
  std::vector<float> raw_N;       ///< statically calibrated sensor without compensation
};

/// U_max(t) = U_min + a exp(-b t) + c fitted to the measured maxima (eq. 3); only U_min + c and a, b are
/// determined by the maxima, U_min comes from the minima.
struct DecayFit {
  bool valid = false;
  double a_V = 0, b_per_s = 0, c_V = 0, u_min_V = 0;
  double u_a_V = 0, u_b_per_s = 0, u_c_V = 0;
  double rmse_V = 0;    ///< eq. (8)
  double loss_pct = 0;  ///< 100 (1 - (U_max(end) - U_min) / (U_max(0) - U_min))
  std::uint64_t n = 0;
};

struct CaseResult {
  std::string id;  ///< "sine_0.50Hz_1.5N/q50"
  std::string title;
  std::string lane;
  std::string loop;      ///< "open" or "closed"
  std::string stimulus;  ///< "sine f_Hz=0.5 A_N=1.05 m_N=2.15"
  StimulusFacts facts;
  std::string parameter_source;  ///< "Lebosse 2011, Table II" or "ours"
  double duration_s = 0.0;
  std::uint64_t samples = 0;
  std::string specimen;
  std::uint64_t seed = 0;
  Calibration calibration;
  std::vector<Check> checks;
  std::vector<ExtremaSeries> extrema;
  DecayFit decay;
  std::vector<PlotTrace> overview;  ///< whole record, decimated
  std::vector<PlotTrace> window;    ///< a few chosen cycles at full rate
  std::string window_reason;        ///< "worst maximum", "last five cycles"
  double lag_s = 0.0;               ///< of the second channel against the first
  double u_lag_s = 0.0;
  DutCounters link;
  std::string digest;  ///< XXH3 (128 bits) over all samples in and out
  int attempts = 1;
  std::string trace_file;  ///< relative path when the samples were kept, else ""
  std::string note;        ///< error text when the case could not be run
};

struct RunResult {
  int format = kResultFormat;
  std::string tool_version;
  std::string command_line;  ///< that repeats the run
  std::string started_at;    ///< the only wall-clock field, ISO 8601
  std::string plan_name, plan_sha256;
  std::uint64_t seed = 0;
  std::string firmware_path, firmware_sha256;
  DutInfo firmware;
  RigInfo rig;
  std::string decision_rule;
  Decision decision;
  std::vector<Check> checks;  ///< checks of the whole run (panel means, self-check)
  std::vector<CaseResult> cases;
  std::map<std::string, std::string> environment;  ///< compiler, emulator versions
  std::vector<std::string> notes;  ///< things a reader must know: calibration level, substitutions
  std::optional<Error> not_written;  ///< why its folder is not there, of the run that made it; stands in no file
};

}  // namespace forcegate
