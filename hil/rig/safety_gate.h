#pragma once
// The only place that clips a command or stops a rig. Every velocity goes through command(), every sample
// through run(). A stop is final for the record: the rig is parked and no further motion is accepted.

#include <cstdint>
#include <string>

#include "hil/base/result.h"
#include "hil/interface/rig.h"

namespace forcegate {

struct SafetyLimits {
  double force_max_N = 5.0;             ///< ATI force, pushed or pulled, that stops the record; the sensor's range ends there
  double velocity_max_rad_per_s = 0.0;  ///< beside that of the rig's geometry; 0: that one alone
  int reference_lost_samples = 250;     ///< consecutive samples without a valid ATI reading that stop it, at most 0.25 s of them
};

enum class StopReason { none, force_limit, reference_lost, motor_fault, bad_command, rig_stopped };
std::string_view to_string(StopReason reason);  ///< "none", "force above the limit" ...

struct SafetyReport {
  StopReason reason = StopReason::none;
  double t_s = 0.0;      ///< rig time of the stop
  double force_N = 0.0;  ///< ATI force that caused it
  std::uint64_t clipped_commands = 0;
  std::uint64_t travel_samples = 0;  ///< samples with the wheel at the end of its travel
  double travel_first_s = 0.0;
  bool stopped() const { return reason != StopReason::none; }
};

class SafetyGate {
 public:
  SafetyGate(Rig& rig, const SafetyLimits& limits);
  ~SafetyGate();  ///< parks the rig
  SafetyGate(const SafetyGate&) = delete;
  SafetyGate& operator=(const SafetyGate&) = delete;

  Result<void> begin(const RigRecordRequest& request);

  /// Clips to the velocity limit, to the rig's fastest change of force and, at an end of travel, to the inward
  /// direction. A command that is not
  /// finite stops the record. After a stop commands are ignored. Returns what the rig was told.
  Result<double> command(double velocity_rad_per_s);

  /// Rig::run, then every new sample is looked at. On a stop the rig is parked, the rows from the offending
  /// one on carry kRigSafetyStop, and the next call returns 0.
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at);

  const SafetyReport& report() const { return report_; }
  Rig& rig() { return rig_; }

 private:
  bool all_sound(const RigBlock& rows, std::size_t at, std::size_t n) const;
  void stop(StopReason reason, double t_s, double force_N);

  Rig& rig_;
  SafetyLimits limits_;
  double rate_max_N_per_s_ = 0.0;
  double force_max_N_ = 0.0;  ///< the weaker of plan and bench
  RigGeometry geometry_;
  bool can_move_ = false;
  int lost_run_ = 0, lost_max_ = 0;
  double last_t_s_ = 0.0;
  SafetyReport report_;
};

}  // namespace forcegate
