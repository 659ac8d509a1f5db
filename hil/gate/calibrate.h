#pragma once
// What the harness finds out about a specimen before any sample counts (docs/gate.md, 1).
//
//   static      slow sweeps on the rig, least squares of F_ref = G U + F0 (Lebosse 2011, eq. 1)
//   identified  and an earlier dynamic record: U_max(t) = U_min + a exp(-b t) + c fitted to the maxima (eq.
//   3), then
//               b_scale = b / (0.0019 f + 0.0056), q_scale = (c / a) (1 + 1.377 A^2)  (eq. 5)

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "hil/gate/case_record.h"
#include "hil/interface/rig.h"

namespace forcegate {

/// The paper's values for the type of sensor: what the rig declares as nominal, else 0.5 N/V and 0 N.
Calibration nominal_calibration(const RigInfo& info);

/// Makes the records that job.calibrate asks for and fills CaseRecord::calibration, its uncertainties, decay
/// and calibration_text. Never fails: see CaseRecord::failure.
CaseRecord run_calibration(const CaseJob& job, Rig& rig, const std::atomic<bool>* cancelled = nullptr);

/// What every image takes (docs/protocol.md); it refuses a calibration beyond.
struct CalibrationBounds {
  double gain_min_N_per_V = 1e-3, gain_max_N_per_V = 100.0, offset_N = 50.0, scale_min = 0.01, scale_max = 100.0;
};
inline constexpr CalibrationBounds kCalibrationBounds;

/// The number of a calibration that no image takes, with its bounds; "" where all are taken.
std::string beyond_what_images_take(const Calibration& calibration);

/// A calibration file, and the converter that it was made with where it states one.
struct CalibrationFile {
  std::filesystem::path path;
  Calibration calibration;  ///< its converter is not yet that of a rig
  std::optional<int> adc_bits;
  std::optional<double> v_range_V;
};

/// Keys gain_N_per_V (0.001-100), offset_N (-50 to 50), b_scale, q_scale (0.01-100), level, id (all optional but the first
/// two), adc_bits (8-16), v_range_V (0.1-100 V). Errors: config, with the line.
Result<CalibrationFile> read_calibration_file(const std::filesystem::path& path);

/// What the firmware is told on this rig: the file, with the rig's converter. Errors (config): the file states another
/// converter, and a code would be another voltage to the firmware than it was to the rig.
Result<Calibration> calibration_on(const RigInfo& info, const CalibrationFile& file);

}  // namespace forcegate
