#pragma once
// A byte stream in 64-byte vendor reports of a HID device: byte 0 is the number of bytes used (0-63), the rest is the
// stream of docs/protocol.md. What is below carries whole reports: hidraw, or the twin's pseudo terminal.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hil/interface/transport.h"

namespace forcegate::hid {

inline constexpr std::size_t kReportSize = 64;
using Report = std::array<std::uint8_t, kReportSize>;

/// At most 63 bytes.
Report pack(std::span<const std::uint8_t> bytes);
/// nullopt: the first byte is no length.
std::optional<std::span<const std::uint8_t>> unpack(std::span<const std::uint8_t, kReportSize> report);

class ReportLine final : public Transport {
 public:
  explicit ReportLine(std::unique_ptr<Transport> reports) : reports_(std::move(reports)) {}
  Result<void> write(std::span<const std::uint8_t> bytes, double timeout_s) override;
  Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) override;
  std::string name() const override { return reports_->name(); }

 private:
  std::unique_ptr<Transport> reports_;
  std::vector<std::uint8_t> raw_, bytes_;
};

/// ErrorCode::device when there is no such device, or several and no serial number tells them apart.
Result<std::unique_ptr<Transport>> open_hidraw(unsigned short vendor, unsigned short product,
                                               const std::string& serial);

}  // namespace forcegate::hid
