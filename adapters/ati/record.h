#pragma once
// Records of the ATI stand-alone F/T controller on RS-232 (ATI 9620-05-CTL).
//   binary: error u8 (0 = good) | Fx Fy Fz Tx Ty Tz as big-endian i16 counts | sum of the 13 bytes modulo 256 (CD E)
//   ASCII:  error digit, six signed decimals padded with blanks, separated by commas, CR LF
// There is no sync byte: a lost byte shifts all records that follow, which only checksum and plausibility can tell.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace forcegate::ati {

struct Record {
  std::uint8_t error = 0;
  std::array<int, 6> counts{};  ///< Fx Fy Fz Tx Ty Tz
};

enum class Parse { value, invalid, need_more };

struct ParseResult {
  Parse kind = Parse::need_more;
  std::size_t consumed = 0;
  Record record;
  std::string_view reason{};
};

/// Front of a binary stream whose first byte begins a record.
ParseResult parse_binary(std::span<const std::uint8_t> stream, bool checksum);

/// Front of an ASCII stream. A line that is not exactly a record is invalid as a whole. `width`: bytes of a line with its
/// CR LF when known (all records of one controller have the same), 0 otherwise.
ParseResult parse_ascii(std::span<const std::uint8_t> stream, std::size_t width);

}  // namespace forcegate::ati
