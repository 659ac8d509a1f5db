#pragma once
// The three instruments of a bench. Each is one file in adapters/ that registers itself; byte decoding inside it is a
// pure function that answers value, invalid or need more. Errors name the instrument in `where` ("motor: ...",
// "reference: ...", "board: ...") so that the right party is asked to act.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/base/device_clock.h"
#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/bench_world.h"
#include "hil/interface/dut.h"

namespace forcegate {

struct DeviceIdentity {
  std::string model, serial, firmware, calibration;
  bool by_file = false;  ///< serial and calibration are what the bench file says; the instrument cannot tell
};

class Device {
 public:
  virtual ~Device() = default;
  /// Connects, identifies, configures. Nothing moves. May be called again after close().
  virtual Result<DeviceIdentity> open() = 0;
  virtual void close() noexcept = 0;
  /// Counts of what the link survived ("retries", "drained bytes"), for the report.
  virtual std::map<std::string, std::uint64_t> counts() const { return {}; }
  /// Its clock against the bench's; no exchanges: it has told no time.
  virtual ClockFit clock() const { return {}; }
};

struct MotorState {
  double t_s = 0.0;  ///< bench time of the request
  double theta_rad = 0.0, velocity_rad_per_s = 0.0;
  bool running = false, fault = false;
  std::uint32_t fault_code = 0;
};

/// A velocity drive. It must be able to stop by itself when nobody talks to it: arm() sets that time and refuses to
/// arm a drive that does not confirm it.
class MotorDrive : public Device {
 public:
  virtual Result<void> arm() = 0;
  /// rad/s, refused (ErrorCode::safety) unless armed.
  virtual Result<void> command_velocity(double rad_per_s) = 0;
  /// One verified round trip; also the heartbeat that keeps the drive's own timeout from expiring.
  virtual Result<MotorState> read() = 0;
  /// Decelerates; stays armed.
  virtual Result<void> stop() = 0;
  /// Immediate stop in any state, several attempts; disarms.
  virtual Result<void> emergency() = 0;
  /// Makes a drive that reports a fault forget it, stopped and switched off first: nothing moves afterwards. Errors: config
  /// where the drive cannot be reset from here, device where the fault stays.
  virtual Result<void> reset_fault() {
    return fail(ErrorCode::config, "this adapter cannot reset the fault of its drive", "motor", "find its cause, then reset it at the drive");
  }
  virtual double drive_timeout_s() const = 0;
  /// Largest speed that it takes in either direction; infinite: it does not say.
  virtual double velocity_limit_rad_per_s() const { return std::numeric_limits<double>::infinity(); }
};

struct ReferenceReading {
  double t_s = 0.0;          ///< bench time of the measurement as far as the link tells
  float force_N = 0.0f;      ///< NaN when not valid
  std::uint16_t status = 0;  ///< RigStatus bits
};

struct ReferenceFacts {
  double rate_Hz = 0.0;
  double u_time_s = 0.0;          ///< standard uncertainty of ReferenceReading::t_s
  double counts_per_force = 0.0;  ///< scale that the bench file sets; 0: the instrument's own, which only its maker can mend
};

class ReferenceSensor : public Device {
 public:
  virtual Result<void> start() = 0;
  /// Appends what has arrived since the last call, in order. Never waits.
  virtual Result<void> poll(std::vector<ReferenceReading>& out) = 0;
  virtual Result<void> stop() = 0;
  virtual ReferenceFacts facts() const = 0;
};

struct BoardSample {
  std::uint32_t index = 0;  ///< counted by the board from the start of the stream
  std::uint16_t adc = 0;
  float force_N = 0.0f;
  std::uint8_t flags = 0;
};

class SensorBoard : public Device {
 public:
  /// New record: nonce and calibration are echoed, the firmware's state is reset.
  virtual Result<DutInfo> load(const DutSession& session) = 0;
  virtual Result<void> start() = 0;
  virtual Result<void> poll(std::vector<BoardSample>& out) = 0;
  virtual Result<void> stop() = 0;
  virtual DutCounters counters() const = 0;
};

/// Registry entries. `table` is the device's table of the bench file ("motor", "reference", "board").
template <class T>
struct DeviceKind {
  std::string name;  ///< "modbus_motor", "ati_serial", "serial_board" ...
  std::string doc;
  std::function<Result<std::unique_ptr<T>>(const ConfigNode& table, BenchWorld& world)> make;
};
using MotorKind = DeviceKind<MotorDrive>;
using ReferenceKind = DeviceKind<ReferenceSensor>;
using BoardKind = DeviceKind<SensorBoard>;

}  // namespace forcegate
