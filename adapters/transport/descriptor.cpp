#include "adapters/transport/descriptor.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace forcegate {

Descriptor::Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  if (this != &other) {
    reset();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

Descriptor::~Descriptor() { reset(); }

void Descriptor::reset() {
  if (fd_ >= 0) close(fd_);
  fd_ = -1;
}

void close_inherited(int kept) {
  constexpr unsigned kFirst = STDERR_FILENO + 1;
  const auto keep = static_cast<unsigned>(kept);
  if (keep > kFirst) ::close_range(kFirst, keep - 1, 0);
  ::close_range(std::max(keep + 1, kFirst), ~0U, 0);
}

std::string system_text(int error_number) {
  char buffer[128] = "";
  return strerror_r(error_number, buffer, sizeof buffer);
}

Result<void> DescriptorTransport::write(std::span<const std::uint8_t> bytes, double timeout_s) {
  while (!bytes.empty()) {
    ssize_t n = send(fd_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == ENOTSOCK) n = ::write(fd_.get(), bytes.data(), bytes.size());
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
      continue;
    }
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && errno != EAGAIN) return fail(ErrorCode::io, "cannot send: " + system_text(errno), name_);
    pollfd p{fd_.get(), POLLOUT, 0};
    if (poll(&p, 1, static_cast<int>(timeout_s * 1000.0)) == 0)
      return fail(ErrorCode::timeout, "the far end takes no bytes", name_);
  }
  return {};
}

Result<std::size_t> DescriptorTransport::read(std::span<std::uint8_t> into, double timeout_s) {
  for (;;) {
    const ssize_t n = ::read(fd_.get(), into.data(), into.size());
    if (n > 0) return static_cast<std::size_t>(n);
    if (n == 0 || (n < 0 && errno == EIO)) return fail(ErrorCode::io, "the far end is gone", name_);
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return fail(ErrorCode::io, "cannot receive: " + system_text(errno), name_);
    pollfd p{fd_.get(), POLLIN, 0};
    const int ready = poll(&p, 1, static_cast<int>(timeout_s * 1000.0));
    if (ready == 0) return 0;
  }
}

}  // namespace forcegate
