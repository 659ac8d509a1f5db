#pragma once
// `forcegate bench calibrate`: the reference with known masses, the spring against the reference, a sensor by slow sweeps.

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/rig.h"

namespace forcegate {

/// One point: what was laid on or set, and what was read there.
struct CalibrationPoint {
  double x = 0.0;     ///< true force, N; spring: e (1 - cos theta), mm
  double y = 0.0;     ///< mean reading, N
  double s = 0.0;     ///< standard deviation of a reading, N
  std::size_t n = 0;  ///< readings
};

/// y = intercept + slope x by least squares, from at least three points.
struct CalibrationLine {
  std::vector<CalibrationPoint> points;
  double slope = 0.0, intercept = 0.0;
  double u_slope = 0.0, u_intercept = 0.0;  ///< standard uncertainties from the scatter about the line
  double residual = 0.0;                    ///< its standard deviation, n - 2
  double worst = 0.0;                       ///< largest |y - line|
};
/// ErrorCode::device when the points do not tell a line.
Result<CalibrationLine> fit_calibration(std::vector<CalibrationPoint> points);

struct CalibrateRequest {
  std::filesystem::path bench;
  std::map<std::string, std::string> options;  ///< of the session: attach, arm, today ...
  std::vector<double> masses_g{0, 50, 100, 200, 300, 400};
  double mass_u_rel = 1e-4;           ///< of the masses
  double gravity_m_per_s2 = 9.80665;  ///< at the place
  double seconds = 2.0;               ///< of each point
  double settle_s = 1.0;
  std::size_t steps = 8;  ///< spring: angles on the way up, and again down
  std::string specimen;   ///< sensor
  const std::atomic<bool>* stop = nullptr;
};

/// Called before each point with what a person is to do now; returns when it is done. Null: the twins do it.
using Guide = std::function<Result<void>(const std::string& instruction)>;

struct Calibrated {
  std::string what;  ///< "reference", "spring", "sensor"
  std::optional<CalibrationLine> line;
  std::vector<std::string> findings;     ///< sentences for a person
  std::vector<std::string> bench_lines;  ///< to enter into the bench file, or the calibration file's own
  double u_rel = 0.0;
};

/// Masses on the reference, wheel unloaded; nothing moves. The scale that follows: reading = slope x true force.
Result<Calibrated> calibrate_reference(const CalibrateRequest& request, const Guide& guide);
/// Angle up to which the spring is calibrated, rad: 95 % of the travel up to theta_max_rad and to 95 % of the force limit,
///   k (preload + e (1 - cos theta)) <= 0.95 force_max_N;   0 where the preload alone is beyond it.
double spring_top_rad(const RigGeometry& geometry, double force_max_N);
/// The wheel turns slowly through its travel and back: F = k preload + k e (1 - cos theta). ErrorCode::config where the force limit
/// leaves no travel.
Result<Calibrated> calibrate_spring(const CalibrateRequest& request);
/// Two slow sweeps: F = gain U + offset (Lebosse 2011, eq. 1), as the gate makes them.
Result<Calibrated> calibrate_sensor(const CalibrateRequest& request);

}  // namespace forcegate
