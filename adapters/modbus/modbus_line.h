#pragma once
// libmodbus behind a wrapper that never lets a stale reply pass for a fresh one. RTU has no transaction id: after one
// late reply every later read succeeds with the answer to an earlier request. So
//   - the input is flushed before every request;
//   - after any error the line is left alone for the drive's worst reply time, drained until it stays empty twice;
//   - values count only when the rolling heartbeat, written just before, is read back with them.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/bench_world.h"

namespace forcegate::modbus {

struct LineOptions {
  bool tcp = false;
  std::string host = "127.0.0.1";
  int tcp_port = 502;
  std::string path;  ///< of the serial port (RTU)
  LineSettings serial;
  int slave = 1;
  int response_timeout_ms = 150, byte_timeout_ms = 20;
  int min_gap_ms = 0;        ///< silence between messages that the drive needs
  int worst_reply_ms = 300;  ///< latest moment at which an answer to an old request may still come
  bool lock = true;          ///< RTU: refuse a port that another program holds
};

class ModbusLine {
 public:
  explicit ModbusLine(LineOptions options);
  ~ModbusLine();
  ModbusLine(const ModbusLine&) = delete;
  ModbusLine& operator=(const ModbusLine&) = delete;

  Result<void> connect();
  void close() noexcept;
  bool connected() const { return context_ != nullptr; }
  std::string name() const;

  /// One message each; no retry. ErrorCode::timeout or ErrorCode::device.
  Result<std::vector<std::uint16_t>> read(int function, int address, int count);
  Result<void> write(int function, int address, std::span<const std::uint16_t> words);
  /// Function 23: the write is executed before the read.
  Result<std::vector<std::uint16_t>> write_and_read(int write_address, std::span<const std::uint16_t> words,
                                                    int read_address, int count);

  /// After an error: waits out late replies and drains the line.
  void drain();
  std::uint64_t drained_bytes() const { return drained_bytes_; }

 private:
  struct Context;
  void before_request();
  Error error_of(int number, const std::string& what) const;
  std::string help_with(int number) const;

  LineOptions options_;
  std::unique_ptr<Context> context_;
  std::uint64_t drained_bytes_ = 0;
  double last_end_s_ = 0.0;
};

}  // namespace forcegate::modbus
