// Sensor board on USB HID: the link of docs/protocol.md in 64-byte vendor reports.

#include "adapters/board/link_board.h"
#include "adapters/hid/report_line.h"

namespace forcegate {
namespace {

Result<std::unique_ptr<SensorBoard>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[board]", "docs/bench.md");
  LinkBoardOptions o;
  std::int64_t vendor = 0, product = 0, bits = 16, batch = 8, timeout_ms = 1000;
  for (const char* elsewhere : {"adapter", "v_range_V", "flash"}) in.any(elsewhere);
  in.integer("vendor_id", vendor, 1, 0xFFFF, ConfigReader::required);
  in.integer("product_id", product, 1, 0xFFFF, ConfigReader::required);
  in.text("serial", o.serial, ConfigReader::required);
  in.integer("adc_bits", bits, 8, 16);
  double rate_Hz = 0.0;  // the bench file hands it to the session, and what the firmware tells must be that
  in.number("rate_Hz", rate_Hz, 100, 10000);
  in.integer("batch", batch, 1, 32);
  in.integer("reply_timeout_ms", timeout_ms, 10, 60000);
  FORCEGATE_CHECK_OK(in.finish());
  o.adc_bits = static_cast<int>(bits);
  o.serial_by_file = false;
  o.batch = static_cast<int>(batch);
  o.reply_timeout_s = static_cast<double>(timeout_ms) * 1e-3;
  const auto open = [&world, vendor, product, serial = o.serial]() -> Result<std::unique_ptr<Transport>> {
    FORCEGATE_TRY(auto reports, world.open_hid(static_cast<unsigned short>(vendor),
                                               static_cast<unsigned short>(product), serial));
    return std::make_unique<hid::ReportLine>(std::move(reports));
  };
  return std::make_unique<LinkBoard>(o, open, world);
}

const Registration<BoardKind> kRegistered{
    {"hid_board", "Sensor board on USB HID, link protocol in 64-byte vendor reports", make}};

}  // namespace
}  // namespace forcegate
