#pragma once
// Raw data transfer of ATI Net F/T over UDP (ATI 9620-05-NET FT), all fields big-endian.
//   request: u16 0x1234 | u16 command | u32 sample count (0 = endless)
//   record:  u32 rdt_sequence | u32 ft_sequence | u32 status | i32 Fx Fy Fz Tx Ty Tz
// and the page netftapi2.xml with the scale of the counts.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::ati {

enum class RdtCommand : std::uint16_t { stop = 0, stream = 2, clear_latch = 0x41, bias = 0x42 };
inline constexpr std::size_t kRdtRecordSize = 36;

std::array<std::uint8_t, 8> encode_rdt(RdtCommand command, std::uint32_t samples);

struct RdtRecord {
  std::uint32_t rdt_sequence = 0, ft_sequence = 0, status = 0;
  std::array<std::int32_t, 6> counts{};  ///< Fx Fy Fz Tx Ty Tz
};
/// Records of one datagram; false when its length is no multiple of 36.
bool decode_rdt(std::span<const std::uint8_t> datagram, std::vector<RdtRecord>& out);

enum class RdtHealth { good, saturated, fault };
/// 0 and 0x80010000 (a monitor condition) are good; bit 17 is saturation.
RdtHealth rdt_health(std::uint32_t status);

struct NetFtConfig {
  std::string product;
  double counts_per_force = 0.0, newtons_per_unit = 0.0;
  double rate_Hz = 0.0;  ///< 0 when the page does not say it
};
/// Refuses a page in which product, scale or unit is missing, doubled, not positive or unknown.
Result<NetFtConfig> parse_netft_page(std::string_view xml);

}  // namespace forcegate::ati
