#pragma once
// The harness's end of the control socket of twins (host.h): one line out, one line back.

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "adapters/transport/unix_socket.h"
#include "hil/base/result.h"

namespace forcegate::emulated {

class TwinClient {
 public:
  /// Waits for a host that is just starting.
  static Result<TwinClient> connect(const std::filesystem::path& folder, double timeout_s);
  /// The reply without "ok "; an "error ..." reply becomes an Error.
  Result<std::string> say(const std::string& line);
  /// status as key = value.
  Result<std::map<std::string, std::string>> status();

 private:
  explicit TwinClient(std::unique_ptr<Transport> line) : line_(std::move(line)) {}
  std::unique_ptr<Transport> line_;
  std::string pending_;
};

}  // namespace forcegate::emulated
