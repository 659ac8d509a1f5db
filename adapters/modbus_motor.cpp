// Velocity drive over Modbus RTU or TCP. What its registers mean is declared in the bench file (docs/bench.md). Every
// reading is proved fresh: a rolling counter is written to a scratch register of the drive and must come back with it.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "adapters/modbus/modbus_line.h"
#include "adapters/modbus/register_map.h"
#include "hil/base/text.h"
#include "hil/interface/device.h"

namespace forcegate {
namespace {

using namespace modbus;

constexpr int kLongestBlock = 125;  // registers of one read, by function 3, 4 or 23
constexpr double kJumpMargin_rad = 0.05;
constexpr int kResetLooks = 10, kResetLook_ms = 100;

class ModbusMotor final : public MotorDrive {
 public:
  ModbusMotor(RegisterMap map, LineOptions line, std::string device_port, BenchWorld& world)
      : map_(std::move(map)), options_(std::move(line)), port_(std::move(device_port)), world_(world) {
    for (const auto& [name, condition] : map_.state) watched_.push_back(&map_.reg.at(condition.reg));
    for (const char* name : {"position", "velocity_actual", "fault_code"})
      if (const auto at = map_.reg.find(name); at != map_.reg.end()) watched_.push_back(&at->second);
    watched_.push_back(&map_.reg.at(map_.heartbeat.reg));
    blocks_ = merge_reads(watched_, 8, kLongestBlock);
  }
  ~ModbusMotor() override { close(); }

  Result<DeviceIdentity> open() override {
    close();
    FORCEGATE_CHECK_OK(connect());
    last_theta_.reset();
    DeviceIdentity identity{"Modbus drive", "", "", ""};
    FORCEGATE_CHECK_OK(read());
    if (const auto at = map_.reg.find("serial"); at != map_.reg.end()) {
      FORCEGATE_TRY(const auto words, verified([&] {
                      return line_->read(at->second.read_function, at->second.address, at->second.size());
                    }));
      identity.serial = std::to_string(decode_bits(at->second, words));
    }
    return identity;
  }

  void close() noexcept override {
    if (armed_) (void)emergency();
    line_.reset();
  }

  Result<void> arm() override {
    FORCEGATE_TRY(const MotorState state, read());
    if (state.fault)
      return fail(ErrorCode::device, fmt::format("the drive reports fault {:#x}", state.fault_code), where(),
                  "find its cause in the drive's manual, then forcegate bench reset with the bench file");
    const Register& timeout = map_.reg.at(map_.heartbeat.drive_timeout_reg);
    FORCEGATE_TRY(const auto words, encode(timeout, map_.heartbeat.drive_timeout_ms));
    FORCEGATE_CHECK_OK(write_register(timeout, words));
    FORCEGATE_TRY(const bool kept, verified([&] { return keeps_timeout(); }));
    if (!kept)
      return fail(ErrorCode::safety, "the drive does not accept its communication timeout: it would not stop when the harness dies", where(),
                  "set [motor.heartbeat] drive_timeout_reg to the register of the drive's own timeout");
    told_ = ran_ = false;
    FORCEGATE_CHECK_OK(run_command("enable", std::nullopt));
    armed_ = true;
    return {};
  }

  Result<void> command_velocity(double rad_per_s) override {
    if (!armed_)
      return fail(ErrorCode::safety, "the drive is not armed: nothing moves", where(), "arm it first");
    told_ = true;
    return run_command("run", rad_per_s);
  }

  Result<MotorState> read() override {
    if (!line_) return fail(ErrorCode::device, "the drive is not open", where());
    FORCEGATE_TRY(MotorState state, verified([&] { return read_once(); }));
    if (last_theta_) {  // a jump that no motor can make is not believed at once
      const double reach = kJumpMargin_rad + 1.5 * *map_.reg.at("velocity_set").high * (state.t_s - last_t_s_);
      if (std::fabs(state.theta_rad - *last_theta_) > reach) {
        ++implausible_;
        FORCEGATE_TRY(const MotorState again, verified([&] { return read_once(); }));
        if (std::fabs(again.theta_rad - state.theta_rad) > reach || std::fabs(again.theta_rad - *last_theta_) > reach)
          return fail(ErrorCode::device, fmt::format("the drive's position jumps from {:.3f} to {:.3f} rad", *last_theta_, state.theta_rad),
                      where(), "check encoder, word order and scale of the register 'position'");
        state = again;
      }
    }
    last_theta_ = state.theta_rad;
    last_t_s_ = state.t_s;
    if (state.running) ran_ = true;
    if (state.running || state.fault) return state;
    written_.clear();
    if (!armed_ || !told_) return state;
    // Told to run once more it would run on without the timeout that it forgot when it began anew.
    FORCEGATE_TRY(const bool kept, verified([&] { return keeps_timeout(); }));
    if (!kept) return forgotten();
    if (!ran_) return state;
    return fail(ErrorCode::device, "the drive has stopped running, and nobody told it to", where(),
                "look whether another hand stopped it; state 'running' must hold at velocity 0 too");
  }

  Result<void> stop() override {
    told_ = ran_ = false;
    return run_command("stop", std::nullopt);
  }

  Result<void> emergency() override {
    armed_ = told_ = false;
    written_.clear();
    Error last{ErrorCode::device, "the drive is not open", where(), {}};
    for (int attempt = 0; attempt < 4; ++attempt) {
      if (!line_ || !line_->connected()) {
        // A stop goes out even on a line that another process holds.
        if (auto connected = connect(attempt == 0); !connected) {
          last = connected.error();
          continue;
        }
      }
      Result<void> sent;
      for (const Step& step : map_.cmd.at("emergency"))
        if (sent = write_step(step, std::nullopt); !sent) break;
      if (sent) return {};
      last = sent.error();
      if (attempt < 2)
        line_->drain();
      else
        line_->close();
    }
    return Unexpected(last);
  }

  Result<void> reset_fault() override {
    const auto command = map_.cmd.find("fault_reset");
    if (command == map_.cmd.end())
      return fail(ErrorCode::config, "the bench file does not say how the drive is reset", "[motor.cmd]",
                  "add fault_reset with what the drive's manual says, or reset it at the drive");
    FORCEGATE_CHECK_OK(emergency());  // a drive that still holds its command to run would obey it without its fault
    for (const Step& step : command->second) FORCEGATE_CHECK_OK(verified([&] { return write_step(step, std::nullopt); }));
    MotorState state;
    for (int look = 0; look < kResetLooks; ++look) {
      if (look > 0) std::this_thread::sleep_for(std::chrono::milliseconds(kResetLook_ms));
      FORCEGATE_TRY(state, read());
      if (!state.fault) return {};
    }
    return fail(ErrorCode::device, fmt::format("the drive still reports fault {:#x}", state.fault_code), where(),
                "find its cause in the drive's manual: it is still there, or this fault goes with the power only");
  }

  double drive_timeout_s() const override { return map_.heartbeat.drive_timeout_ms * 1e-3; }
  double velocity_limit_rad_per_s() const override {
    const Register& set = map_.reg.at("velocity_set");
    return std::min(-*set.low, *set.high);
  }

  std::map<std::string, std::uint64_t> counts() const override {
    return {{"retries", retries_},
            {"reconnects", reconnects_},
            {"stale replies refused", stale_},
            {"position jumps refused", implausible_},
            {"drained bytes", line_ ? line_->drained_bytes() : 0}};
  }

 private:
  std::string where() const { return "motor: " + (line_ ? line_->name() : port_); }

  Result<void> connect(bool lock = true) {
    LineOptions options = options_;
    options.lock = lock;
    if (options.tcp) {
      FORCEGATE_TRY(options.tcp_port, world_.tcp_port("motor", options.tcp_port));
    } else {
      FORCEGATE_TRY(options.path, world_.serial_path(port_));
    }
    line_.emplace(std::move(options));
    return line_->connect();
  }

  /// Runs an exchange; after an error the line is drained and proved by the heartbeat before the next try.
  template <class F>
  auto verified(F exchange) -> decltype(exchange()) {
    auto result = exchange();
    for (int attempt = 1; !result && attempt < map_.heartbeat.max_missed; ++attempt) {
      if (result.error().code != ErrorCode::timeout && result.error().code != ErrorCode::device) break;
      ++retries_;
      line_->drain();
      if (!prove()) {
        ++reconnects_;
        line_->close();
        // a late echo of the same register would pass for the answer to a write
        if (auto connected = line_->connect(); !connected || !prove()) continue;
      }
      if (armed_) {  // what did not answer may have been one that began anew
        const auto kept = keeps_timeout();
        if (!kept) continue;
        if (!*kept) return forgotten();
      }
      result = exchange();
    }
    return result;
  }

  Result<void> beat() {
    const Register& reg = map_.reg.at(map_.heartbeat.reg);
    ++counter_;
    const std::uint16_t word = counter_;
    return line_->write(reg.write_function, reg.address, {&word, 1});
  }

  bool prove() {
    const Register& reg = map_.reg.at(map_.heartbeat.reg);
    for (int i = 0; i < 2; ++i) {
      if (!beat()) {
        line_->drain();
        continue;
      }
      const auto echoed = line_->read(reg.read_function, reg.address, 1);
      if (echoed && (*echoed)[0] == counter_) return true;
      if (echoed) ++stale_;
      line_->drain();
    }
    return false;
  }

  Result<MotorState> read_once() {
    MotorState state;
    state.t_s = world_.now_s();
    const Register& heart = map_.reg.at(map_.heartbeat.reg);
    std::vector<std::vector<std::uint16_t>> values;
    // Function 23 reads holding registers: what function 4 reads lies elsewhere.
    if (map_.heartbeat.read_write_together && blocks_.size() == 1 && blocks_[0].function == 3) {
      const std::uint16_t word = ++counter_;
      FORCEGATE_TRY(auto words, line_->write_and_read(heart.address, {&word, 1}, blocks_[0].address, blocks_[0].count));
      values.push_back(std::move(words));
    } else {
      FORCEGATE_CHECK_OK(beat());
      // The block with the heartbeat comes last: a reply shifted by any number of requests cannot match it.
      for (const ReadBlock& block : blocks_) {
        FORCEGATE_TRY(auto words, line_->read(block.function, block.address, block.count));
        values.push_back(std::move(words));
      }
      if (blocks_.size() > 1) {
        FORCEGATE_TRY(const auto echoed, line_->read(heart.read_function, heart.address, 1));
        if (echoed[0] != counter_) return stale();
      }
    }
    const auto words_of = [&](const Register& r) {
      for (std::size_t i = 0; i < blocks_.size(); ++i) {
        const ReadBlock& b = blocks_[i];
        if (b.function == r.read_function && r.address >= b.address && r.address + r.size() <= b.address + b.count)
          return std::span<const std::uint16_t>(values[i]).subspan(static_cast<std::size_t>(r.address - b.address),
                                                                   static_cast<std::size_t>(r.size()));
      }
      return std::span<const std::uint16_t>();
    };
    if (words_of(heart)[0] != counter_) return stale();
    for (const auto& [name, condition] : map_.state) {
      const Register& r = map_.reg.at(condition.reg);
      const bool equal = (decode_bits(r, words_of(r)) & condition.mask) == condition.value;
      if (name == "fault") state.fault = equal == condition.equal;
      if (name == "running") state.running = equal == condition.equal;
    }
    if (const auto at = map_.reg.find("fault_code"); at != map_.reg.end())
      state.fault_code = decode_bits(at->second, words_of(at->second));
    const Register& position = map_.reg.at("position");
    FORCEGATE_TRY(state.theta_rad, decode(position, words_of(position)));
    if (const auto at = map_.reg.find("velocity_actual"); at != map_.reg.end()) {
      FORCEGATE_TRY(state.velocity_rad_per_s, decode(at->second, words_of(at->second)));
    }
    return state;
  }

  Result<bool> keeps_timeout() {
    const Register& timeout = map_.reg.at(map_.heartbeat.drive_timeout_reg);
    FORCEGATE_TRY(const auto words, encode(timeout, map_.heartbeat.drive_timeout_ms));
    FORCEGATE_TRY(const auto echoed, line_->read(timeout.read_function, timeout.address, timeout.size()));
    return echoed == words;
  }

  Unexpected forgotten() const {
    return fail(ErrorCode::safety, "the drive has lost its communication timeout while it was armed: it has begun anew, and would not stop when the harness dies",
                where(), "look at its supply and emergency switch, and for what resets it");
  }

  Unexpected stale() {
    ++stale_;
    return fail(ErrorCode::device, "the drive answers with the reply to an earlier request", where());
  }

  Result<void> write_register(const Register& reg, std::span<const std::uint16_t> words) {
    return verified([&] { return line_->write(reg.write_function, reg.address, words); });
  }

  Result<void> write_step(const Step& step, std::optional<double> argument) {
    const Register& reg = map_.reg.at(step.reg);
    if (step.after_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(step.after_ms));
    std::vector<std::uint16_t> words;
    if (step.raw) {
      FORCEGATE_TRY(words, encode_raw(reg, *step.raw));
    } else if (argument) {
      FORCEGATE_TRY(words, encode(reg, *argument));
    } else {
      return fail(ErrorCode::config, "a command without argument writes no value to register '" + step.reg + "'", where());
    }
    return line_->write(reg.write_function, reg.address, words);
  }

  /// Steps whose value the register already has are left out, so that a control period is two messages.
  Result<void> run_command(const std::string& name, std::optional<double> argument) {
    if (!line_) return fail(ErrorCode::device, "the drive is not open", where());
    for (const Step& step : map_.cmd.at(name)) {
      const Register& reg = map_.reg.at(step.reg);
      std::vector<std::uint16_t> words;
      if (step.raw) {
        FORCEGATE_TRY(words, encode_raw(reg, *step.raw));
      } else if (argument) {
        FORCEGATE_TRY(words, encode(reg, *argument));
      }
      if (const auto at = written_.find(step.reg); at != written_.end() && at->second == words) continue;
      const std::uint64_t before = retries_;
      auto sent = verified([&] { return write_step(step, argument); });
      if (!sent || retries_ != before) written_.clear();
      FORCEGATE_CHECK_OK(sent);
      written_[step.reg] = words;
    }
    return {};
  }

  RegisterMap map_;
  LineOptions options_;
  std::string port_;
  BenchWorld& world_;
  std::optional<ModbusLine> line_;
  std::vector<const Register*> watched_;
  std::vector<ReadBlock> blocks_;
  std::map<std::string, std::vector<std::uint16_t>> written_;
  bool armed_ = false, told_ = false, ran_ = false;  ///< told to run; seen to run since
  std::uint16_t counter_ = 0;
  std::optional<double> last_theta_;
  double last_t_s_ = 0.0;
  std::uint64_t retries_ = 0, reconnects_ = 0, stale_ = 0, implausible_ = 0;
};

Result<std::unique_ptr<MotorDrive>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[motor]", "docs/bench.md");
  in.any("adapter");
  LineOptions line;
  std::string port = "motor0", kind = "rtu", parity = "even";
  std::int64_t base = 0, response = 150, byte = 20, gap = 0, worst = 300, baud = 115200, slave = 1,
               tcp_port = 502;
  in.integer("address_base", base, 0, 1);
  in.integer("response_timeout_ms", response, 5, 5000);
  in.integer("byte_timeout_ms", byte, 1, 5000);
  in.integer("min_gap_ms", gap, 0, 1000);
  in.integer("worst_reply_ms", worst, 5, 5000);
  if (const ConfigNode* link = in.table("link", ConfigReader::required)) {
    ConfigReader l(*link, "'link' of [motor]", "docs/bench.md");
    l.choice("kind", kind, {"rtu", "tcp"}, ConfigReader::required);
    l.integer("slave", slave, 1, 247);
    if (kind == "tcp") {
      l.text("host", line.host, ConfigReader::required);
      l.integer("tcp_port", tcp_port, 0, 65535);
    } else {
      l.text("port", port, ConfigReader::required);
      l.integer("baud", baud, 1200, 1000000);
      l.choice("parity", parity, {"none", "even", "odd"});
    }
    FORCEGATE_CHECK_OK(l.finish());
  }
  FORCEGATE_TRY(RegisterMap map, read_register_map(in, static_cast<int>(base)));
  FORCEGATE_CHECK_OK(in.finish());
  line.tcp = kind == "tcp";
  line.tcp_port = static_cast<int>(tcp_port);
  line.serial.baud = static_cast<unsigned>(baud);
  line.serial.parity = parity == "even"  ? LineParity::even
                       : parity == "odd" ? LineParity::odd
                                         : LineParity::none;
  line.slave = static_cast<int>(slave);
  line.response_timeout_ms = static_cast<int>(response);
  line.byte_timeout_ms = static_cast<int>(byte);
  line.min_gap_ms = static_cast<int>(gap);
  line.worst_reply_ms = static_cast<int>(worst);
  return std::make_unique<ModbusMotor>(std::move(map), std::move(line), port, world);
}

const Registration<MotorKind> kRegistered{
    {"modbus_motor", "Velocity drive over Modbus RTU or TCP; its registers are declared in the bench file",
     make}};

}  // namespace
}  // namespace forcegate
