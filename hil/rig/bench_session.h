#pragma once
// The instruments of one bench, opened together and made safe together. Nothing moves before arm().

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include "hil/interface/device.h"
#include "hil/rig/bench_file.h"
#include "hil/rig/lease.h"
#include "hil/rig/park_guard.h"
#include "hil/rig/tick_clock.h"

namespace forcegate {

class BenchSession {
 public:
  /// Options: "attach" = folder of twins that are being served, "clock" = virtual | paced, "arm" = yes (a real bench
  /// moves only then). Makes the world and the adapters; opens nothing.
  static Result<std::unique_ptr<BenchSession>> make(BenchFile bench,
                                                    const std::map<std::string, std::string>& options);
  ~BenchSession();

  /// Takes the lease of the bench, then opens all three instruments, the motor last. Idempotent.
  Result<void> open();
  struct Opened {
    Result<void> reference, board, motor;
  };
  /// The same, each by itself whatever the others say. Errors: the bench is held by another.
  Result<Opened> open_each();
  /// Starts the guard and arms the drive. ErrorCode::safety on a real bench without the option arm.
  Result<void> arm();
  bool armed() const { return armed_; }
  /// An error where the guard has left: it has stopped the motor, or nobody would.
  Result<void> beat();
  /// Motor stopped, streams off, guard dismissed when the stop was confirmed. In any state. False: the drive was armed
  /// and has confirmed no stop; the guard goes on trying when we are gone.
  bool make_safe() noexcept;
  /// make_safe() and all instruments closed.
  void close() noexcept;

  const BenchFile& bench() const { return bench_; }
  BenchWorld& world() { return *world_; }
  /// How late the harness came back from a wait that was to end at due_s (bench time).
  void ticked(double due_s) {
    if (world_->is_virtual()) return;
    const double now_s = world_->now_s(), late_s = now_s - due_s;
    ticks_.add(late_s);
    if (ticks_.ticks() == 1) first_tick_s_ = due_s;
    if (late_s > bench_.limits.reference_stale_s) {
      ++late_ticks_;
      late_time_s_ += now_s - std::max(due_s, last_tick_s_);  // what is caught up with was late once
    }
    last_tick_s_ = now_s;
  }
  /// How long an instrument took to answer, for who asks what held the loop up.
  template <class Call>
  auto timed(const char* what, Call call) {
    const double before_s = world_->now_s();
    auto result = call();
    const double now_s = world_->now_s(), took_s = now_s - before_s;
    if (took_s > slowest_call_s_) slowest_call_s_ = took_s, slowest_call_ = what;
    if (took_s > bench_.limits.reference_stale_s && !world_->is_virtual()) late_time_s_ += took_s, last_tick_s_ = now_s;
    return result;
  }
  MotorDrive& motor() { return *motor_; }
  ReferenceSensor& reference() { return *reference_; }
  SensorBoard& board() { return *board_; }
  /// Identities after open(), counts, clocks and lateness so far, as "reference serial" -> "FT12345", "link retries" -> "0".
  std::map<std::string, std::string> details() const;

 private:
  BenchSession(BenchFile bench, std::map<std::string, std::string> options);
  Result<void> start_guard();
  Result<void> take_lease();
  template <class Device>
  Result<void> open_device(const std::string& name, Device& device);

  BenchFile bench_;
  std::map<std::string, std::string> options_;
  std::unique_ptr<BenchWorld> world_;
  std::unique_ptr<MotorDrive> motor_;
  std::unique_ptr<ReferenceSensor> reference_;
  std::unique_ptr<SensorBoard> board_;
  ParkGuard guard_;
  Lease lease_;
  TickHistogram ticks_;
  std::uint64_t late_ticks_ = 0;  ///< later than a reading of the reference counts
  double late_time_s_ = 0.0, first_tick_s_ = 0.0, last_tick_s_ = 0.0, slowest_call_s_ = 0.0;
  const char* slowest_call_ = "";
  RealTime real_time_;
  bool open_ = false, armed_ = false;
  std::map<std::string, DeviceIdentity> identity_;
};

/// Opens a line of its own to the drive of a bench and stops it at once; for the guard and `forcegate bench park`.
Result<void> stop_motor_now(const BenchFile& bench, std::map<std::string, std::string> options);

}  // namespace forcegate
