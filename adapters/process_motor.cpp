// Velocity drive whose adapter is a program of its own, in any language (docs/adapters.md).

#include <cmath>

#include "adapters/process/adapter_process.h"

namespace forcegate {
namespace {

using process::AdapterProcess;
using process::ProcessOptions;
using process::Reply;

class ProcessMotor final : public MotorDrive {
 public:
  ProcessMotor(ProcessOptions program, double velocity_max, double timeout_s, BenchWorld& world)
      : program_(std::move(program), world),
        world_(world),
        velocity_max_rad_per_s_(velocity_max),
        drive_timeout_s_(timeout_s) {}
  ~ProcessMotor() override { close(); }

  Result<DeviceIdentity> open() override {
    close();
    FORCEGATE_TRY(const DeviceIdentity identity, program_.open(true));
    FORCEGATE_CHECK_OK(read());
    return identity;
  }
  void close() noexcept override {
    if (armed_) (void)emergency();
    if (program_.running()) (void)program_.ask("close");
    program_.end();
  }

  Result<void> arm() override {
    FORCEGATE_TRY(const Reply reply, program_.ask("arm", {{"timeout_s", drive_timeout_s_}}));
    const auto echoed = reply.number.find("timeout_s");
    if (echoed == reply.number.end() || std::fabs(echoed->second - drive_timeout_s_) > 1e-3) {
      (void)program_.ask("emergency");
      return fail(ErrorCode::safety,
                  "the drive does not confirm its communication timeout: it would not stop when the "
                  "harness dies",
                  program_.where(),
                  "the program must set the timeout, read it back from the drive and answer 'timeout_s'");
    }
    armed_ = true;
    told_ = ran_ = false;
    return {};
  }

  Result<void> command_velocity(double rad_per_s) override {
    if (!armed_)
      return fail(ErrorCode::safety, "the drive is not armed: nothing moves", program_.where(),
                  "arm it first");
    if (!(std::fabs(rad_per_s) <= velocity_max_rad_per_s_))
      return fail(ErrorCode::safety, "the velocity is beyond the limit of the drive", program_.where());
    told_ = true;
    FORCEGATE_CHECK_OK(program_.ask("velocity", {{"rad_per_s", rad_per_s}}));
    return {};
  }

  Result<MotorState> read() override {
    MotorState state;
    state.t_s = world_.now_s();
    FORCEGATE_TRY(const Reply reply, program_.ask("read"));
    const auto number = [&](const char* key, double& out) {
      const auto at = reply.number.find(key);
      if (at == reply.number.end()) return false;
      out = at->second;
      return true;
    };
    double running = 0.0, fault = 0.0, code = 0.0;
    if (!number("theta_rad", state.theta_rad) || !number("running", running) || !number("fault", fault))
      return program_.bad("the answer to 'read' needs theta_rad, running and fault");
    number("velocity_rad_per_s", state.velocity_rad_per_s);
    number("fault_code", code);
    if (!(code >= 0 && code <= 4294967295.0)) return program_.bad("fault_code is no whole number of 32 bits");
    state.running = running != 0.0;
    state.fault = fault != 0.0;
    state.fault_code = static_cast<std::uint32_t>(code);
    // One that began anew has forgotten its timeout: it must not be told to run once more.
    if (armed_ && told_ && ran_ && !state.running && !state.fault)
      return fail(ErrorCode::device, "the drive has stopped running, and nobody told it to", program_.where(),
                  "look whether it was reset or another hand stopped it; 'running' must hold at velocity 0 too");
    if (state.running) ran_ = true;
    return state;
  }

  Result<void> stop() override {
    told_ = ran_ = false;
    FORCEGATE_CHECK_OK(program_.ask("stop"));
    return {};
  }

  /// A program that does not obey is killed and started anew, without asking who else has the port.
  Result<void> emergency() override {
    armed_ = told_ = false;
    Error last;
    for (int attempt = 0; attempt < 3; ++attempt) {
      if (!program_.running()) {
        if (auto opened = program_.open(false); !opened) {
          last = opened.error();
          continue;
        }
      }
      auto stopped = program_.ask("emergency");
      if (stopped) return {};
      last = stopped.error();
      program_.end();
    }
    return Unexpected(last);
  }

  double drive_timeout_s() const override { return drive_timeout_s_; }
  double velocity_limit_rad_per_s() const override { return velocity_max_rad_per_s_; }
  std::map<std::string, std::uint64_t> counts() const override { return program_.counts(); }
  ClockFit clock() const override { return program_.clock().fit(); }

 private:
  AdapterProcess program_;
  BenchWorld& world_;
  double velocity_max_rad_per_s_, drive_timeout_s_;
  bool armed_ = false, told_ = false, ran_ = false;  ///< told to run; seen to run since
};

Result<std::unique_ptr<MotorDrive>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[motor]", "docs/adapters.md");
  ProcessOptions program;
  program.device = "motor";
  process::read_process_options(in, table, program);
  double velocity_max = 0.0;
  std::int64_t timeout_ms = 0;
  in.number("velocity_max_rad_per_s", velocity_max, 0.001, 1000, ConfigReader::required);
  in.integer("drive_timeout_ms", timeout_ms, 20, 5000, ConfigReader::required);
  FORCEGATE_CHECK_OK(in.finish());
  return std::make_unique<ProcessMotor>(std::move(program), velocity_max,
                                        static_cast<double>(timeout_ms) * 1e-3, world);
}

const Registration<MotorKind> kRegistered{
    {"process", "Drive behind a program of its own, in any language (docs/adapters.md)", make}};

}  // namespace
}  // namespace forcegate
