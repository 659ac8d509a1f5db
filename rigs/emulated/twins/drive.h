#pragma once
// A velocity drive as its Modbus master sees it, in the manner of small brushless drives (control and status words,
// 32-bit values high word first, communication timeout as a parameter). Addresses are wire addresses from 0.
//
//   0x007D  control      bit 5 excited, bit 3 run; 0x28 run, 0x20 decelerate and hold, 0x00 stop at once, power off
//   0x0100  status       bit 0 excited, bit 5 running, bit 7 alarm
//   0x0101  alarm code   0 none, 0x10 following error, 0x84 communication timeout
//   0x0102  position     i32, 131072 counts per turn of the wheel
//   0x0104  velocity     i32, 0.0001 rad/s
//   0x0106  scratch      u16, read and write
//   0x0180  alarm reset  write 1
//   0x0200  serial       u32
//   0x0480  velocity set i32, 0.0001 rad/s, |v| <= 40 rad/s
//   0x1000  communication timeout, ms, 0 = never; 20 to 5000

#include <array>
#include <cstdint>

#include "rigs/emulated/twins/modbus_server.h"

namespace forcegate::emulated {

class Drive final : public RegisterBank {
 public:
  static constexpr int kFollowingError = 0x10, kCommunicationTimeout = 0x84;

  std::optional<std::uint16_t> read(int address) override;
  int write(int address, std::uint16_t word) override;

  void power_cycle();
  void heard(double t_s) { heard_s_ = t_s; }
  /// Instant at which the watchdog will stop the drive unless somebody talks to it.
  double watchdog_s() const;
  /// Called as time passes; true when the watchdog has just stopped the drive.
  bool tick(double t_s);
  void see(double theta_rad, double velocity_rad_per_s, bool following_error);
  void freeze(bool on) { frozen_ = on; }

  /// What the shaft is to do now.
  double velocity_rad_per_s() const;
  bool running() const { return (control_ & 0x28U) == 0x28U && alarm_ == 0; }
  int alarm() const { return alarm_; }

 private:
  std::uint16_t status() const;
  std::uint16_t control_ = 0, scratch_ = 0, timeout_ms_ = 0;
  std::int32_t velocity_set_ = 0, position_ = 0, velocity_ = 0;
  int alarm_ = 0;
  double heard_s_ = 0.0;
  bool frozen_ = false;
};

}  // namespace forcegate::emulated
