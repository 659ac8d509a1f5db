#include "rigs/emulated/twins/wire.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>

namespace forcegate::emulated {
namespace {

constexpr std::size_t kRestMax = 4096;

sockaddr_in loopback(std::uint16_t network_port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = network_port;
  return address;
}

}  // namespace

Result<void> Wire::open_terminal(const std::filesystem::path& link) {
  link_ = link;
  Descriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  char name[128] = "";
  if (!master || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0 ||
      ptsname_r(master.get(), name, sizeof name) != 0)
    return fail(ErrorCode::io, "cannot make a pseudo terminal: " + system_text(errno), "/dev/ptmx",
                "end programs that hold some; /proc/sys/kernel/pty/max is how many there may be");
  keeper_ = Descriptor(open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios raw{};
  if (!keeper_ || tcgetattr(keeper_.get(), &raw) != 0)
    return fail(ErrorCode::io, "cannot open a pseudo terminal: " + system_text(errno), name);
  cfmakeraw(&raw);
  tcsetattr(keeper_.get(), TCSANOW, &raw);
  std::error_code error;
  std::filesystem::remove(link, error);
  std::filesystem::create_symlink(name, link, error);
  if (error)
    return fail(ErrorCode::io, "cannot publish a port: " + error.message(), link.string(), "name a folder that exists or can be made, and that you may write into (bench serve: --folder)");
  terminal_ = WireEnd{std::move(master), 0, 0, {}};
  unplugged_ = false;
  return {};
}

Result<int> Wire::open_server(int port) {
  Descriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  sockaddr_in address = loopback(htons(static_cast<std::uint16_t>(port)));
  if (fd) setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  socklen_t size = sizeof address;
  if (!fd || bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      listen(fd.get(), 8) != 0 || getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return fail(ErrorCode::io,
                "cannot listen on TCP port " + std::to_string(port) + ": " + system_text(errno), "127.0.0.1",
                "end the program that has it, or give 0 in the bench file: any free port");
  listener_ = std::move(fd);
  return ntohs(address.sin_port);
}

Result<int> Wire::open_datagrams(int port) {
  Descriptor fd(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  sockaddr_in address = loopback(htons(static_cast<std::uint16_t>(port)));
  socklen_t size = sizeof address;
  if (!fd || bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return fail(ErrorCode::io, "cannot bind UDP port " + std::to_string(port) + ": " + system_text(errno), "127.0.0.1",
                "end the program that has it, or give 0 in the bench file: any free port");
  terminal_.fd = std::move(fd);
  datagrams_ = true;
  return ntohs(address.sin_port);
}

void Wire::attach() {
  terminal_.received = terminal_.sent = 0;
  terminal_.rest.clear();
}

void Wire::poll_descriptors(std::vector<int>& out) const {
  if (unplugged_) return;
  if (terminal_.fd) out.push_back(terminal_.fd.get());
  if (listener_) out.push_back(listener_.get());
  for (const WireEnd& c : clients_)
    if (c.fd) out.push_back(c.fd.get());
}

double Wire::clock_s(double t_s) const {
  if (!wall_delays_) return t_s;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool Wire::read_end(WireEnd& end, double t_s) {
  std::uint8_t bytes[4096];
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t n =
        datagrams_ ? recvfrom(end.fd.get(), bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&from), &size)
                   : ::read(end.fd.get(), bytes, sizeof bytes);
    if (n > 0 && datagrams_) peer_port_ = from.sin_port;
    if (n <= 0) return !(n == 0 || (errno != EAGAIN && errno != EINTR && errno != EIO));
    end.received += static_cast<std::uint64_t>(n);
    if (faults_.active(device_, WireFault::stall, t_s)) continue;  // nobody listens
    end.rest.insert(end.rest.end(), bytes, bytes + n);
    on_bytes(end);
    if (!end.fd) return false;
    if (end.rest.size() > kRestMax) end.rest.clear();
  }
}

void Wire::receive(double t_s) {
  if (unplugged_) return;
  if (listener_)
    for (;;) {
      Descriptor peer(accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!peer) break;
      const int yes = 1;
      setsockopt(peer.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      clients_.push_back(WireEnd{std::move(peer), 0, 0, {}});
    }
  if (terminal_.fd) read_end(terminal_, t_s);
  for (WireEnd& c : clients_)
    if (c.fd && !read_end(c, t_s)) c.fd.reset();
  while (!clients_.empty() && !clients_.front().fd && delayed_.empty()) clients_.pop_front();
}

void Wire::put(WireEnd& end, std::span<const std::uint8_t> bytes) {
  if (!end.fd) return;
  if (datagrams_) {
    const sockaddr_in to = loopback(peer_port_);
    const ssize_t n = sendto(end.fd.get(), bytes.data(), bytes.size(), 0,
                             reinterpret_cast<const sockaddr*>(&to), sizeof to);
    if (n > 0) end.sent += static_cast<std::uint64_t>(n);
    return;
  }
  while (!bytes.empty()) {
    ssize_t n = ::send(end.fd.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == ENOTSOCK) n = ::write(end.fd.get(), bytes.data(), bytes.size());
    if (n <= 0) {
      if (n < 0 && errno == EINTR) continue;
      return;  // nobody reads the line: what does not fit is lost, as on a real one
    }
    end.sent += static_cast<std::uint64_t>(n);
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void Wire::send(WireEnd* end, Bytes message, double t_s) {
  if (end == nullptr) end = &terminal_;
  if (unplugged_ || !end->fd || message.empty()) return;
  double garbage_bytes = 0.0, delay_ms = 0.0;
  if (faults_.active(device_, WireFault::stall, t_s)) return;
  if (faults_.hit(device_, WireFault::drop, t_s)) return;
  if (faults_.hit(device_, WireFault::drop_byte, t_s))
    message.erase(message.begin() + static_cast<std::ptrdiff_t>(rng_.below(message.size())));
  if (!message.empty() && faults_.hit(device_, WireFault::corrupt, t_s))
    message[rng_.below(message.size())] ^= static_cast<std::uint8_t>(1U << rng_.below(8));
  if (faults_.hit(device_, WireFault::truncate, t_s)) message.resize(message.size() / 2);
  if (faults_.hit(device_, WireFault::garbage, t_s, &garbage_bytes)) {
    Bytes noise(static_cast<std::size_t>(garbage_bytes));
    for (std::uint8_t& b : noise) b = static_cast<std::uint8_t>(rng_.next());
    message.insert(message.begin(), noise.begin(), noise.end());
  }
  const bool twice = faults_.hit(device_, WireFault::duplicate, t_s);
  if (faults_.hit(device_, WireFault::delay, t_s, &delay_ms) || !delayed_.empty()) {
    delayed_.push_back({clock_s(t_s) + delay_ms * 1e-3, end, message});
    if (twice) delayed_.push_back(delayed_.back());
    return;
  }
  put(*end, message);
  if (twice) put(*end, message);
}

double Wire::send_due(double t_s) {
  const double now = clock_s(t_s);
  while (!delayed_.empty() && delayed_.front().due_s <= now) {
    if (!unplugged_) put(*delayed_.front().end, delayed_.front().message);
    delayed_.pop_front();
  }
  if (delayed_.empty() || !wall_delays_) return -1.0;
  return delayed_.front().due_s - now;
}

void Wire::apply_plug(double t_s) {
  const bool cut = faults_.active(device_, WireFault::unplug, t_s);
  if (cut == unplugged_) return;
  if (cut) {
    unplugged_ = true;
    for (WireEnd& c : clients_) c.fd.reset();
    if (datagrams_) return;  // nobody hears a cable that is out
    if (!link_.empty()) {
      keeper_.reset();
      terminal_.fd.reset();  // a client now reads an end of file
      std::error_code ignored;
      std::filesystem::remove(link_, ignored);
    }
    return;
  }
  unplugged_ = false;
  if (!link_.empty()) (void)open_terminal(link_);
}

}  // namespace forcegate::emulated
