#include "adapters/transport/unix_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>

namespace forcegate {
namespace {

Result<sockaddr_un> address_of(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string text = path.string();
  if (text.size() >= sizeof address.sun_path)
    return fail(ErrorCode::config, "the path is too long for a Unix socket", text,
                "set TMPDIR to a shorter path");
  std::memcpy(address.sun_path, text.c_str(), text.size() + 1);
  return address;
}

}  // namespace

Result<UnixListener> UnixListener::listen_at(const std::filesystem::path& path) {
  FORCEGATE_TRY(const sockaddr_un address, address_of(path));
  Descriptor fd(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd || bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(fd.get(), 1) != 0)
    return fail(ErrorCode::io, "cannot listen on a Unix socket: " + system_text(errno), path.string(),
                "set TMPDIR to a folder of a short name that can be written");
  return UnixListener(std::move(fd), path);
}

Result<std::unique_ptr<Transport>> UnixListener::accept_peer(double timeout_s) {
  pollfd p{fd_.get(), POLLIN, 0};
  if (poll(&p, 1, static_cast<int>(timeout_s * 1000.0)) <= 0) return std::unique_ptr<Transport>();
  Descriptor peer(accept4(fd_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!peer) return fail(ErrorCode::io, "cannot accept a peer: " + system_text(errno), path_.string());
  return std::make_unique<DescriptorTransport>(std::move(peer), "unix:" + path_.string());
}

Result<std::unique_ptr<Transport>> connect_unix(const std::filesystem::path& path) {
  FORCEGATE_TRY(const sockaddr_un address, address_of(path));
  Descriptor fd(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd || connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return fail(ErrorCode::io, "cannot connect to a Unix socket: " + system_text(errno), path.string());
  return std::make_unique<DescriptorTransport>(std::move(fd), "unix:" + path.string());
}

}  // namespace forcegate
