#include "rigs/emulated/twins/control_socket.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "adapters/transport/descriptor.h"

namespace forcegate::emulated {

Result<sockaddr_un> free_control_address(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof address.sun_path)
    return fail(ErrorCode::config, "the folder of the twins has too long a name", path.string());
  std::memcpy(address.sun_path, path.c_str(), path.string().size() + 1);
  const Descriptor fd(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!fd) return fail(ErrorCode::io, "cannot open the control socket: " + system_text(errno), path.string());
  // what a host left that was killed answers nobody
  if (connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return address;
  ucred peer{};
  socklen_t size = sizeof peer;
  const bool known = getsockopt(fd.get(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 && peer.pid > 0;
  return fail(ErrorCode::config, "twins are served in this folder already" + (known ? ", by process " + std::to_string(peer.pid) : std::string()), path.parent_path().string(),
              "give another folder, or end that process");
}

}  // namespace forcegate::emulated
