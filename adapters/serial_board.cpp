// Sensor board on a serial line, link protocol of docs/protocol.md.

#include "adapters/board/link_board.h"

namespace forcegate {
namespace {

Result<std::unique_ptr<SensorBoard>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[board]", "docs/bench.md");
  LinkBoardOptions o;
  std::string port;
  std::int64_t baud = 460800, bits = 16, batch = 10, timeout_ms = 1000;
  for (const char* elsewhere : {"adapter", "v_range_V", "flash"}) in.any(elsewhere);
  in.text("port", port, ConfigReader::required);
  in.integer("baud", baud, 1200, 4000000);
  in.integer("adc_bits", bits, 8, 16);
  double rate_Hz = 0.0;  // the bench file hands it to the session, and what the firmware tells must be that
  in.number("rate_Hz", rate_Hz, 100, 10000);
  in.integer("batch", batch, 1, 32);
  in.integer("reply_timeout_ms", timeout_ms, 10, 60000);
  in.text("serial", o.serial, ConfigReader::required);
  FORCEGATE_CHECK_OK(in.finish());
  o.adc_bits = static_cast<int>(bits);
  o.batch = static_cast<int>(batch);
  o.reply_timeout_s = static_cast<double>(timeout_ms) * 1e-3;
  const LineSettings line{static_cast<unsigned>(baud), LineParity::none};
  return std::make_unique<LinkBoard>(
      o, [&world, port, line] { return world.open_line(port, line); }, world);
}

const Registration<BoardKind> kRegistered{
    {"serial_board", "Sensor board on a serial line, link protocol (docs/protocol.md)", make}};

}  // namespace
}  // namespace forcegate
