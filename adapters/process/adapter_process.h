#pragma once
// A program that is an instrument's adapter: started by the bench, spoken to over its standard input and output, ended
// with the bench. What it writes to standard error is shown when it dies.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/process/messages.h"
#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "hil/base/device_clock.h"
#include "hil/interface/bench_world.h"
#include "hil/interface/device.h"

namespace forcegate::process {

struct ProcessOptions {
  std::string device;                ///< "motor", "reference", "board"
  std::vector<std::string> command;  ///< program and arguments; a program with '/' is relative to the bench file
  std::filesystem::path bench_folder;
  std::filesystem::path folder;      ///< where it runs; relative to the bench file
  std::string port;                  ///< of [ports]; "" = the program needs none
  ConfigNode options;                ///< handed on as they are
  double reply_timeout_s = 1.0, start_timeout_s = 5.0;
};

/// Keys command, folder, port, options, reply_timeout_ms, start_timeout_ms.
void read_process_options(ConfigReader& in, const ConfigNode& table, ProcessOptions& out);

class AdapterProcess {
 public:
  AdapterProcess(ProcessOptions options, BenchWorld& world) : options_(std::move(options)), world_(world) {}
  ~AdapterProcess() { end(); }

  /// Starts the program and lets it open its instrument. `exclusive` false: although somebody else has the port.
  Result<DeviceIdentity> open(bool exclusive);
  /// Closes its input, waits a moment, then kills it.
  void end() noexcept;
  bool running() const { return line_ != nullptr; }

  /// One request and its answer. An answer to an earlier request is never taken for it. Errors carry `where()`.
  Result<Reply> ask(std::string_view verb, const Fields& fields = {});
  std::string where() const;
  Unexpected bad(const std::string& what) const;

  /// The program's clock, from the `clock_s` of its answers.
  const DeviceClock& clock() const { return clock_; }
  std::map<std::string, std::uint64_t> counts() const {
    return {{"stale replies refused", stale_}, {"restarts", restarts_}};
  }

 private:
  Result<Reply> exchange(std::string_view verb, const Fields& fields, double timeout_s);
  Unexpected gone();

  ProcessOptions options_;
  BenchWorld& world_;
  std::optional<PrivateFolder> log_folder_;
  ChildProcess child_;
  std::unique_ptr<Transport> line_;
  std::string pending_;
  std::uint64_t next_id_ = 1, stale_ = 0, restarts_ = 0;
  bool started_before_ = false;
  DeviceClock clock_;
};

}  // namespace forcegate::process
