#include "adapters/link/cobs.h"

namespace forcegate::link {

std::vector<std::uint8_t> cobs_encode(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> out{0};
  std::size_t code = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] != 0) out.push_back(bytes[i]);
    const bool full = bytes[i] != 0 && out.size() - code == 255 && i + 1 < bytes.size();
    if (bytes[i] == 0 || full) {
      out[code] = static_cast<std::uint8_t>(out.size() - code);
      code = out.size();
      out.push_back(0);
    }
  }
  out[code] = static_cast<std::uint8_t>(out.size() - code);
  return out;
}

std::optional<std::vector<std::uint8_t>> cobs_decode(std::span<const std::uint8_t> bytes) {
  std::vector<std::uint8_t> out;
  out.reserve(bytes.size());
  std::size_t i = 0;
  while (i < bytes.size()) {
    const std::size_t code = bytes[i++];
    if (code == 0 || i + code - 1 > bytes.size()) return std::nullopt;
    for (const std::size_t end = i + code - 1; i < end; ++i) {
      if (bytes[i] == 0) return std::nullopt;
      out.push_back(bytes[i]);
    }
    if (code != 255 && i < bytes.size()) out.push_back(0);
  }
  return out;
}

}  // namespace forcegate::link
