#pragma once
// What must hold while a person's slow program has the wheel: the drive is well, the reference speaks, the force is within the bench's limit.

#include <limits>
#include <vector>

#include "hil/rig/bench_session.h"

namespace forcegate {

/// Watch over an armed session whose reference is started. Make it anew where nobody looked for a while: silence counts from here.
class ForceWatch {
 public:
  explicit ForceWatch(BenchSession& session) : session_(session), heard_s_(session.world().now_s()) {}

  /// Lets 10 ms pass, tells the guard of the motor that the harness lives, and looks. `readings()` holds what came meanwhile.
  /// Errors: safety (force beyond the bench's limit in either direction, a reading that is not valid, a reference that is silent for 0.25 s, a
  /// guard that is gone), device (drive fault). The motor is as it was: see made_safe().
  Result<MotorState> look();

  const std::vector<ReferenceReading>& readings() const { return readings_; }
  double force_N() const { return force_N_; }  ///< last reading; NaN before the first

 private:
  Result<void> hear(const ReferenceReading& reading);

  BenchSession& session_;
  std::vector<ReferenceReading> readings_;
  double heard_s_;
  double force_N_ = std::numeric_limits<double>::quiet_NaN();
};

/// Stops the motor because of `error`, which then says whether the drive has confirmed that.
Error made_safe(BenchSession& session, Error error);

}  // namespace forcegate
