#pragma once
// A HID device with 64-byte vendor reports that exists only inside umockdev-wrapper.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::test {

class MockHid {
 public:
  /// /dev/hidraw0 with these numbers. `folder` takes the script of its ioctls.
  static Result<std::unique_ptr<MockHid>> plug_in(unsigned short vendor, unsigned short product,
                                                  const std::string& serial, const std::string& folder);
  ~MockHid();
  /// Whole reports that the host has written since the last call, without their report number.
  std::vector<std::vector<std::uint8_t>> written();
  /// One report towards the host; false when its queue is full (the pseudo terminal behind it would cut one in two).
  bool send(const std::vector<std::uint8_t>& report);
  void pull_out();

 private:
  MockHid() = default;
  struct Testbed;
  std::unique_ptr<Testbed> testbed_;
  int master_ = -1, keeper_ = -1;
  std::vector<std::uint8_t> pending_;
};

}  // namespace forcegate::test
