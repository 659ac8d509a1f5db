#pragma once
// One TOML file per bench: which instruments, on which ports, within which limits, with which calibrations and geometry.
// docs/bench.md lists the keys; every mistake is named with file, line and column.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/interface/rig.h"

namespace forcegate {

inline constexpr int kBenchFormat = 1;

struct BenchCalibration {
  std::string what;  ///< "reference", "spring", "sensor" ...
  std::string id;
  std::string expires;  ///< "2027-01-31"
};

struct BenchLimits {
  double force_max_N = 5.0;  ///< the weaker of sensor and reference
  double velocity_max_rad_per_s = 40.0;
  double force_rate_max_N_per_s = 100.0;
  double reference_stale_s = 0.05;        ///< older readings do not count
  double board_stale_s = 0.1;             ///< a board silent for longer ends the record
  double start_velocity_rad_per_s = 0.5;  ///< of the way to a record's first angle
};

/// Table [specimens]: who has rested long enough.
struct BenchSpecimens {
  std::filesystem::path log;  ///< "" = none is kept
  double rest_s = 7200.0;     ///< a plan may ask for less, not for more
  bool widen = false;         ///< a shorter rest is no refusal but an uncertainty
  double short_rest_u_rel = 0.0;
};

struct BenchFile {
  std::filesystem::path path;
  ConfigNode root;
  std::string name, id, doc;
  bool twins = false;  ///< has [twins]: nothing real moves
  bool paced = false;  ///< and their clock is that on the wall
  std::string motor_adapter, reference_adapter, board_adapter;
  BenchLimits limits;
  RigGeometry geometry;
  BenchSpecimens specimens;
  std::vector<BenchCalibration> calibrations;
  std::string reference_calibration_id;  ///< key calibration_id of [reference]
  double rate_Hz = 1000.0;
  int adc_bits = 16;
  double v_range_V = 10.0;
  double nominal_gain_N_per_V = 0.5, nominal_offset_N = 0.0;
  double reference_resolution_N = 0.025, reference_noise_N = 0.0, reference_u_rel = 0.0;

  const ConfigNode& table(const char* device) const;
};

/// ErrorCode::config with position. Adapters' own keys are checked by the adapters.
Result<BenchFile> read_bench(const std::filesystem::path& path);
Result<BenchFile> read_bench_text(std::string_view text, const std::string& name);

/// Every mistake that the adapters see in their tables, and what the tables say against each other, without opening anything. What
/// stands here does not keep `bench park` from stopping the motor.
Result<void> check_devices(const BenchFile& bench);

/// Calibrations out of date on a day given as "2026-11-21"; ISO dates compare as texts.
std::vector<BenchCalibration> expired(const BenchFile& bench, const std::string& today);

/// Which calibration of the reference is looked after, where that is not the one it is to run with; empty: that very one.
std::string reference_calibration_remark(const BenchFile& bench);
inline constexpr const char* kReferenceCalibrationRemark = "calibration remark";  ///< of RigInfo::details

/// What the gate must know of the bench before any instrument is opened.
RigInfo rig_info(const BenchFile& bench);

}  // namespace forcegate
