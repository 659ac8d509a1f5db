#pragma once

#include <filesystem>
#include <memory>

#include "adapters/transport/descriptor.h"

namespace forcegate {

/// Waits for one peer on a Unix stream socket.
class UnixListener {
 public:
  static Result<UnixListener> listen_at(const std::filesystem::path& path);
  /// nullptr when nobody came within timeout_s.
  Result<std::unique_ptr<Transport>> accept_peer(double timeout_s);

 private:
  UnixListener(Descriptor fd, std::filesystem::path path) : fd_(std::move(fd)), path_(std::move(path)) {}
  Descriptor fd_;
  std::filesystem::path path_;
};

Result<std::unique_ptr<Transport>> connect_unix(const std::filesystem::path& path);

}  // namespace forcegate
