#pragma once
// A golden trace as reviewable text: every k-th extremum of the whole record and a few short windows of its waveform,
// with tolerances and provenance, so that a change shows in a diff. Written and read without loss: forces in 0.1 mN.
//
//   forcegate golden 1
//   plan smoke
//   case sine_f0.50_A1.50_m2.70
//   specimen q50
//   seed 7
//   ... (provenance, one line each)
//   digest 5f2c...                   of every line but the tolerances; goldens of older versions have none
//   tolerance ati absolute 0.08 relative 0 scale 0 time_s 0.01 lag_limit_s 0.01
//   tolerance firmware absolute 0.05 relative 0.01 scale 0 time_s 0.01 lag_limit_s 0.02
//   extrema 1196 every 30
//   max 3.512 4.2003 4.1877          instant s, ATI N, firmware N
//   window 2.000 0.050 80            first instant s, step s, rows
//   1.2000 1.1893                    ATI N, firmware N

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "golden/compare/tube.h"

namespace forcegate {

struct GoldenExtremum {
  bool maximum = true;
  double t_s = 0.0, ati_N = 0.0, dut_N = 0.0;
};

struct GoldenWindow {
  double t0_s = 0.0, step_s = 0.0;
  std::vector<float> ati_N, dut_N;
};

/// What is compared of a record.
struct GoldenContent {
  std::vector<GoldenExtremum> extrema;  ///< all of the record; in a golden file every k-th
  std::vector<GoldenWindow> windows;
};

struct GoldenRecord {
  std::string plan, case_name, specimen;
  std::uint64_t seed = 0;
  std::string rig;        ///< "emulated/1"
  std::string algorithm;  ///< of the firmware; only the same one is held against the firmware's curve
  std::map<std::string, std::string>
      provenance;  ///< firmware_sha256, calibration, date, who, reason, mre_maxima_pct
  TubeOptions ati, firmware;
  std::size_t extrema_in_all = 0, every = 1;
  GoldenContent content;
};

/// At most 40 extrema of each kind are kept. Equal goldens give equal bytes.
std::string to_text(const GoldenRecord& golden);
/// Errors (parse) name the line: one that is missing, unknown, given twice or without its value is damage and never passed over,
/// as is any that is not as its digest says.
Result<GoldenRecord> parse_golden_record(std::string_view text, const std::string& name);

/// One extremum or sample of a window.
struct GoldenMargin {
  std::string where;  ///< "max", "min", "window"
  double t_s = 0.0, golden_N = 0.0, tested_N = 0.0;
  double margin_N = 0.0;  ///< signed distance to the edge of the tube, < 0 outside
};

/// How a record stands to its golden, for one of the two curves.
struct GoldenComparison {
  TubeState state = TubeState::not_compared;
  std::string cause;            ///< "" when inside
  double outside = 0.0;         ///< largest |deviation| / tolerance over extrema and windows; <= 1 is inside
  double worst_margin_N = 0.0;  ///< smallest of the margins
  double worst_at_s = 0.0;
  double lag_s = 0.0;                 ///< of the window that lags most; NaN when undetermined
  std::size_t n = 0;                  ///< extrema and samples compared
  std::vector<GoldenMargin> margins;  ///< of each of them
};

enum class GoldenCurve { ati, firmware };

/// Coverage first: another number of extrema, a missing or truncated window, samples that are not numbers are not
/// compared. Then extrema (instants within time_s, forces within the tolerance) and windows (tube.h). The lag of a window
/// that moves by less than the width of the tube is not limited: it is made of noise.
Result<GoldenComparison> compare_golden(const GoldenRecord& golden, const GoldenContent& tested,
                                        GoldenCurve curve);

}  // namespace forcegate
