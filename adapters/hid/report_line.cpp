#include "adapters/hid/report_line.h"

#include <algorithm>
#include <cassert>

namespace forcegate::hid {

Report pack(std::span<const std::uint8_t> bytes) {
  assert(bytes.size() < kReportSize);
  Report report{};
  report[0] = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), report.begin() + 1);
  return report;
}

std::optional<std::span<const std::uint8_t>> unpack(std::span<const std::uint8_t, kReportSize> report) {
  if (report[0] >= kReportSize) return std::nullopt;
  return std::span<const std::uint8_t>(report).subspan(1, report[0]);
}

Result<void> ReportLine::write(std::span<const std::uint8_t> bytes, double timeout_s) {
  while (!bytes.empty()) {
    const std::size_t n = std::min(bytes.size(), kReportSize - 1);
    FORCEGATE_CHECK_OK(reports_->write(pack(bytes.first(n)), timeout_s));
    bytes = bytes.subspan(n);
  }
  return {};
}

Result<std::size_t> ReportLine::read(std::span<std::uint8_t> into, double timeout_s) {
  while (bytes_.empty()) {
    std::uint8_t chunk[kReportSize];  // a hidraw that is asked for more may join two reports
    FORCEGATE_TRY(const std::size_t n, reports_->read(chunk, timeout_s));
    if (n == 0) return std::size_t{0};
    raw_.insert(raw_.end(), chunk, chunk + n);
    if (raw_.size() < kReportSize) continue;
    const auto used = unpack(std::span<const std::uint8_t>(raw_).first<kReportSize>());
    if (used) bytes_.insert(bytes_.end(), used->begin(), used->end());
    raw_.erase(raw_.begin(), raw_.begin() + kReportSize);
  }
  const std::size_t n = std::min(into.size(), bytes_.size());
  std::copy_n(bytes_.begin(), n, into.begin());
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(n));
  return n;
}

}  // namespace forcegate::hid
