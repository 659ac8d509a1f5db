// The twin of the drive on any request: one reply, an echo of the function or its exception, never longer than a
// message may be; and the adapter's view of any registers: a number or an error.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "adapters/modbus/register_map.h"
#include "rigs/emulated/twins/drive.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcegate;
  emulated::Drive drive;
  std::span<const std::uint8_t> rest(data, size);
  while (rest.size() > 1) {
    const std::size_t n = std::min<std::size_t>(1 + rest[0] % 64, rest.size() - 1);
    const auto reply = emulated::modbus_reply(drive, rest.subspan(1, n));
    if (reply.size() < 2 || reply.size() > 253 || (reply[0] & 0x7F) != (rest[1] & 0x7F)) std::abort();
    if (!(std::fabs(drive.velocity_rad_per_s()) <= 40.0)) std::abort();
    drive.tick(1e9);
    rest = rest.subspan(1 + n);
  }
  for (std::size_t i = 0; i + 4 <= size; i += 4) {
    modbus::Register r;
    r.name = "fuzz";
    r.type = static_cast<modbus::WordType>(data[i] % 5);
    r.high_word_first = (data[i] & 8) != 0;
    std::vector<std::uint16_t> words{static_cast<std::uint16_t>(data[i] << 8 | data[i + 1]),
                                     static_cast<std::uint16_t>(data[i + 2] << 8 | data[i + 3])};
    words.resize(static_cast<std::size_t>(r.size()));
    const auto value = modbus::decode(r, words);
    if (value && !std::isfinite(*value)) std::abort();
    if (value && r.type != modbus::WordType::f32 && modbus::encode(r, *value).value() != words) std::abort();
  }
  return 0;
}
