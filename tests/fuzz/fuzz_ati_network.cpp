// Net F/T datagrams and pages, Digital F/T frames, calibrations and gage records from any bytes: values are finite, progress
// is made; and the twins of both on any bytes: they answer or stay silent.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "adapters/ati/digital.h"
#include "adapters/ati/rdt.h"
#include "rigs/emulated/twins/digital_ft.h"
#include "rigs/emulated/twins/netft.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate;
  const std::span<const std::uint8_t> bytes(data, size);
  std::vector<ati::RdtRecord> records;
  if (ati::decode_rdt(bytes, records) != (size > 0 && size % ati::kRdtRecordSize == 0)) std::abort();
  if (records.size() * ati::kRdtRecordSize > size) std::abort();
  for (const ati::RdtRecord& r : records) (void)ati::rdt_health(r.status);
  if (const auto page = ati::parse_netft_page({reinterpret_cast<const char*>(data), size}))
    if (!(page->counts_per_force > 0.0) || !std::isfinite(page->counts_per_force) ||
        !(page->newtons_per_unit > 0.0))
      std::abort();
  for (const std::uint8_t function : {3, 16, 0x46, 0x6A})
    if (const auto reply = ati::decode_frame(bytes, 10, function); reply && reply->size() + 4 != size)
      std::abort();
  ati::GageRecord record;
  for (std::size_t at = 0; at < size; at += ati::kGageRecordSize)
    if (ati::parse_gages(bytes.subspan(at), record) == ati::GageParse::need_more &&
        size - at >= ati::kGageRecordSize)
      std::abort();
  std::vector<std::uint16_t> words(static_cast<std::size_t>(ati::kCalibrationWords));
  for (std::size_t i = 0; i + 1 < size && i / 2 < words.size(); i += 2)
    words[i / 2] = static_cast<std::uint16_t>(data[i] << 8 | data[i + 1]);
  if (const auto c = ati::decode_calibration(words))
    if (!std::isfinite(ati::gage_force_N(*c, record, 2)) || !(c->counts_per_force > 0.0)) std::abort();

  emulated::FaultScript faults;
  emulated::Wire wire("reference", faults, false);
  emulated::WireEnd end;
  end.rest.assign(bytes.begin(), bytes.end());
  emulated::DigitalFt digital({}, wire);
  digital.serve(end, 0.0);
  if (end.rest.size() > size) std::abort();
  digital.row(0.001, 1.0, false);
  emulated::NetFt box({}, wire);
  end.rest.assign(bytes.begin(), bytes.end());
  box.serve(end, 0.0);
  end.rest.assign(bytes.begin(), bytes.end());
  box.serve_page(wire, end, 0.0);
  box.row(0.001, 1.0, false);
  return 0;
}
