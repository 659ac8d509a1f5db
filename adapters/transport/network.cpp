#include "adapters/transport/network.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "adapters/transport/descriptor.h"

namespace forcegate {
namespace {

constexpr std::size_t kPageMax = 256 * 1024;

Result<Descriptor> connect_socket(const std::string& host, int port, int kind, double timeout_s) {
  addrinfo wish{};
  wish.ai_family = AF_UNSPEC;
  wish.ai_socktype = kind;
  addrinfo* list = nullptr;
  const std::string where = host + ":" + std::to_string(port);
  if (const int error = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wish, &list); error != 0)
    return fail(ErrorCode::device, std::string("the network does not know the host: ") + gai_strerror(error),
                where, "check the address in the bench file");
  int last = 0;
  Descriptor found;
  for (const addrinfo* a = list; a != nullptr && !found; a = a->ai_next) {
    Descriptor fd(socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol));
    if (!fd) continue;
    int error = connect(fd.get(), a->ai_addr, a->ai_addrlen) == 0 ? 0 : errno;
    if (error == EINPROGRESS) {
      pollfd p{fd.get(), POLLOUT, 0};
      socklen_t size = sizeof error;
      error = ETIMEDOUT;
      if (poll(&p, 1, static_cast<int>(timeout_s * 1e3)) == 1)
        getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    }
    if (error == 0)
      found = std::move(fd);
    else
      last = error;
  }
  freeaddrinfo(list);
  if (!found)
    return fail(ErrorCode::device, "cannot connect: " + system_text(last), where,
                "check power, network and address");
  return found;
}

/// A datagram without content is none; everything else is as with a stream.
class Datagrams final : public Transport {
 public:
  Datagrams(Descriptor fd, std::string name) : fd_(std::move(fd)), name_(std::move(name)) {}
  Result<void> write(std::span<const std::uint8_t> bytes, double) override {
    if (send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()))
      return {};
    return fail(ErrorCode::io, "cannot send: " + system_text(errno), name_);
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) override {
    for (;;) {
      const ssize_t n = recv(fd_.get(), into.data(), into.size(), 0);
      if (n > 0) return static_cast<std::size_t>(n);
      if (n == 0 || errno == EINTR) continue;
      if (errno != EAGAIN) return fail(ErrorCode::io, "cannot receive: " + system_text(errno), name_);
      pollfd p{fd_.get(), POLLIN, 0};
      if (poll(&p, 1, static_cast<int>(timeout_s * 1e3)) == 0) return 0;
    }
  }
  std::string name() const override { return name_; }

 private:
  Descriptor fd_;
  std::string name_;
};

}  // namespace

Result<std::unique_ptr<Transport>> connect_udp(const std::string& host, int port) {
  FORCEGATE_TRY(Descriptor fd, connect_socket(host, port, SOCK_DGRAM, 1.0));
  return std::make_unique<Datagrams>(std::move(fd), "udp:" + host + ":" + std::to_string(port));
}

Result<std::string> http_get(const std::string& host, int port, const std::string& path, double timeout_s) {
  using Clock = std::chrono::steady_clock;
  const std::string where = "http://" + host + ":" + std::to_string(port) + path;
  FORCEGATE_TRY(Descriptor fd, connect_socket(host, port, SOCK_STREAM, timeout_s));
  DescriptorTransport line(std::move(fd), where);
  const std::string request = "GET " + path + " HTTP/1.0\r\nHost: " + host + "\r\nConnection: close\r\n\r\n";
  FORCEGATE_CHECK_OK(
      line.write({reinterpret_cast<const std::uint8_t*>(request.data()), request.size()}, timeout_s));
  const auto end = Clock::now() + std::chrono::duration<double>(timeout_s);
  std::string page;
  for (;;) {
    std::uint8_t bytes[4096];
    const auto n = line.read(bytes, 0.05);
    if (!n) break;  // the server closes behind the page
    page.append(reinterpret_cast<const char*>(bytes), *n);
    if (page.size() > kPageMax) return fail(ErrorCode::device, "the page is larger than 256 kB", where);
    if (Clock::now() > end)
      return fail(ErrorCode::timeout, "the page does not end", where, "check the network");
  }
  const std::size_t body = page.find("\r\n\r\n");
  if (!page.starts_with("HTTP/1.") || body == std::string::npos || page.substr(8, 5) != " 200 ")
    return fail(ErrorCode::device, "the answer is not a page", where,
                "check that this is the address of the instrument");
  return page.substr(body + 4);
}

}  // namespace forcegate
