// hidapi's hidraw backend. A write carries the report number first (0: unnumbered), a read does not.

#include <fmt/format.h>
#include <hidapi/hidapi.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "adapters/hid/report_line.h"
#include "hil/base/text.h"

namespace forcegate::hid {
namespace {

std::string narrow(const wchar_t* text) {
  std::string out;
  for (; text != nullptr && *text != 0; ++text) out.push_back(*text < 128 ? static_cast<char>(*text) : '?');
  return printable_utf8(out);
}

class Hidraw final : public Transport {
 public:
  Hidraw(hid_device* device, std::string name) : device_(device), name_(std::move(name)) {}
  ~Hidraw() override { hid_close(device_); }
  Hidraw(const Hidraw&) = delete;
  Hidraw& operator=(const Hidraw&) = delete;

  Result<void> write(std::span<const std::uint8_t> report, double) override {
    std::uint8_t numbered[kReportSize + 1] = {};
    const std::size_t n = std::min(report.size(), kReportSize);
    std::memcpy(numbered + 1, report.data(), n);
    if (hid_write(device_, numbered, sizeof numbered) < 0) return gone();
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) override {
    const int n = hid_read_timeout(device_, into.data(), std::min(into.size(), kReportSize),
                                   static_cast<int>(std::ceil(timeout_s * 1e3)));
    if (n < 0) return gone();
    return static_cast<std::size_t>(n);
  }
  std::string name() const override { return name_; }

 private:
  Unexpected gone() const { return fail(ErrorCode::io, "the far end is gone", name_); }
  hid_device* device_;
  std::string name_;
};

}  // namespace

Result<std::unique_ptr<Transport>> open_hidraw(unsigned short vendor, unsigned short product,
                                               const std::string& serial) {
  const std::string where =
      fmt::format("hid:{:04x}:{:04x}{}", vendor, product, serial.empty() ? "" : " " + serial);
  if (hid_init() != 0) return fail(ErrorCode::device, "HID devices cannot be listed", where);
  std::string path;
  int found = 0;
  hid_device_info* const list = hid_enumerate(vendor, product);
  for (const hid_device_info* d = list; d != nullptr; d = d->next) {
    if (!serial.empty() && narrow(d->serial_number) != serial) continue;
    path = d->path;
    ++found;
  }
  hid_free_enumeration(list);
  if (found == 0)
    return fail(ErrorCode::device, "there is no such HID device", where,
                "forcegate bench scan lists what is connected; a udev rule must let you open it");
  if (found > 1)
    return fail(ErrorCode::device, fmt::format("{} HID devices look alike", found), where,
                "give the serial number of one");
  hid_device* const device = hid_open_path(path.c_str());
  if (device == nullptr)
    return fail(ErrorCode::device, "the HID device cannot be opened", where + " " + path,
                "a udev rule must let you open it: docs/bench.md");
  return std::make_unique<Hidraw>(device, where + " " + path);
}

}  // namespace forcegate::hid
