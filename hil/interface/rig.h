#pragma once
// A rig: everything on the table that moves, loads and measures, behind one clock. The emulated rig, the
// replay of a recording and a bench of real instruments are the same thing to the gate.

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"

namespace forcegate {

/// Status bits of one sample; 0 is healthy.
enum RigStatus : std::uint16_t {
  kRigReferenceSaturated = 1 << 0,  ///< the ATI reports overload
  kRigReferenceFault = 1 << 1,      ///< the ATI reports another error
  kRigMotorFault = 1 << 2,          ///< drive fault or following error
  kRigTravelStop = 1 << 3,          ///< the wheel is at the end of its travel
  kRigSafetyStop = 1 << 4,          ///< SafetyGate has parked the rig
  kRigSampleLost = 1 << 5,          ///< this row stands for a sample that never arrived
  kRigAdcRail = 1 << 6,             ///< the converter is at its first or last code
};

/// Columns of equal length, reused between calls. Time is that of the rig's common base.
struct RigBlock {
  std::vector<double> t_s;
  std::vector<float> setpoint_N;   ///< NaN where there is none (replay without F_cmd)
  std::vector<float> force_ref_N;  ///< the ATI reference, NaN where it has no valid reading
  std::vector<std::uint16_t> adc;  ///< raw code of the sensor channel
  std::vector<float> theta_rad;    ///< wheel angle read back from the drive, NaN without a wheel
  std::vector<std::uint16_t> status;

  std::size_t size() const { return t_s.size(); }
  void resize(std::size_t n) {
    t_s.resize(n);
    setpoint_N.resize(n);
    force_ref_N.resize(n);
    adc.resize(n);
    theta_rad.resize(n);
    status.resize(n);
  }
};

/// Geometry that the controller and the spring witness need: F = k (preload + e (1 - cos theta)).
struct RigGeometry {
  double spring_N_per_mm = 0.25;
  double eccentricity_mm = 0.0;
  double preload_mm = 0.0;
  double theta_min_rad = 0.0;  ///< travel of the wheel in servo use
  double theta_max_rad = 3.14159265358979323846;
  double velocity_max_rad_per_s = 0.0;
};

struct RigInfo {
  std::string name;     ///< "emulated", "replay", or the bench's name
  std::string id;       ///< serial or hash that tells one rig from another
  std::string version;  ///< of the physics or of the bench file
  double rate_Hz = 1000.0;
  int adc_bits = 16;
  double v_range_V = 10.0;
  double force_max_N = 5.5;
  double reference_resolution_N = 0.025;
  double reference_noise_N = 0.0;  ///< standard deviation of one reading as declared
  double reference_u_rel = 0.0;    ///< relative standard uncertainty of its calibration
  double reference_u_time_s = 0.0;  ///< standard uncertainty of the time of a reading, once a record has begun
  RigGeometry geometry;
  double force_rate_max_N_per_s = 0.0;  ///< fastest change of force that a command may cause; 0: none
  bool can_move = false;                ///< false: replay, no closed loop, no calibration sweeps
  bool emulated = false;
  /// Calibration ids, firmware of instruments ... "reference_calibration": what the reference says it runs with,
  /// "reference_calibration_expected": what the bench was set up with; they must agree.
  std::map<std::string, std::string> details;
};

/// One record on the rig: which specimen lies on it and how the session began.
struct RigRecordRequest {
  std::string specimen = "nominal";  ///< emulated: "nominal", "q05" ... "q95", "seed:17"; bench: its id
  std::uint64_t seed = 1;            ///< emulated: draws session (G, F0) and noises
  std::uint64_t session = 0;         ///< records of one session share gain and offset
  std::uint64_t record = 0;          ///< tells records of one session apart: each has its own noise
  double rest_before_s = 1e9;        ///< rest since the last cycling of the specimen
  double duration_s = 0.0;
  double force_low_N = 0.0;  ///< range the profile needs: sets eccentricity and preload
  double force_high_N = 0.0;
  /// Faults to inject by name and magnitude: {"reference_saturated", 2.0}. Unknown names are an error.
  std::map<std::string, double> faults;
};

class Dut;

/// Reading of the reference without any load: it tells a zero error of the reference from a spring or a preload that is
/// not what the geometry says.
struct ReferenceZero {
  double mean_N = 0.0, sd_N = 0.0;
  std::uint64_t n = 0;  ///< readings; 0: the rig cannot lift the load off
};

class Rig {
 public:
  virtual ~Rig() = default;

  virtual RigInfo info() const = 0;

  /// What its options come to, those that nobody gave too, as make_rig() takes them: another rig of these plays the same. Empty: nothing of the kind
  /// is known of this rig.
  virtual std::map<std::string, std::string> settings() const { return {}; }

  /// Mounts the specimen, sets the geometry, lets it rest, starts the clocks at t = 0 (angle at preload).
  virtual Result<void> begin(const RigRecordRequest& request) = 0;

  /// Commands the wheel's velocity from now on. Only SafetyGate calls it. Ignored by a replay.
  virtual Result<void> command_velocity(double rad_per_s) = 0;

  /// Advances the rig's clock by at most n samples and writes them to rows [at, at + returned) of
  /// `out` (which has that size already). Returns fewer only at the end of a recording; 0 = ended.
  /// Rows below `at`, written by earlier calls into the same block, may be refined: a slow reference is
  /// interpolated once its next reading has come.
  virtual Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) = 0;

  /// Latest wheel angle, rad, and force by the ATI, newtons, as the controller may read them.
  virtual double theta_rad() const = 0;
  virtual double force_ref_N() const = 0;

  /// The firmware that runs on the rig's own board and answers for the very samples that the rig delivers, and the
  /// name of that lane ("serial", "hid"); nullptr and "": the rig only digitises. May be opened after begin(); lives
  /// as long as the rig.
  virtual Dut* board_firmware() { return nullptr; }
  virtual std::string board_lane() const { return {}; }

  /// Latest unloaded reading: taken by begin() before the load comes on, and again by park().
  virtual ReferenceZero reference_zero() const { return {}; }

  /// Stops the motor and unloads. Never fails, may be called in any state and twice.
  virtual void park() noexcept = 0;
};

/// Registry entry: makes a rig from a bench file or from options ("record" = path for replay).
struct RigKind {
  std::string name;
  std::string doc;
  std::function<Result<std::unique_ptr<Rig>>(const std::map<std::string, std::string>& options)> make;
};

/// By its name. Error (usage): there is none, with the likeliest.
Result<const RigKind*> find_rig(const std::string& name);
Result<std::unique_ptr<Rig>> make_rig(const std::string& name,
                                      const std::map<std::string, std::string>& options);

}  // namespace forcegate
