#pragma once
// File descriptors with an owner, and the two waits that all byte streams share.

#include <cstdint>
#include <span>
#include <string>

#include "hil/interface/transport.h"

namespace forcegate {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();
  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  void reset();

 private:
  int fd_ = -1;
};

/// Closes in a process that was forked everything but `kept`, input, output and log: what it inherits stays open as long as
/// it lives, and whoever waits for the end of a line would wait for it.
void close_inherited(int kept);

/// Text of an errno value.
std::string system_text(int error_number);

/// Transport over any non-blocking descriptor.
class DescriptorTransport final : public Transport {
 public:
  DescriptorTransport(Descriptor fd, std::string name) : fd_(std::move(fd)), name_(std::move(name)) {}
  Result<void> write(std::span<const std::uint8_t> bytes, double timeout_s) override;
  Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) override;
  std::string name() const override { return name_; }
  int descriptor() const { return fd_.get(); }

 private:
  Descriptor fd_;
  std::string name_;
};

}  // namespace forcegate
