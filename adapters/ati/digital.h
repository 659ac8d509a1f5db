#pragma once
// ATI Digital F/T on RS-485 (ATI 9620-05-DIGITAL FT): Modbus RTU frames for set-up, then a stream of gage records.
//   frame:  slave u8 | function u8 | data | CRC-16 (polynomial 0xA001, start 0xFFFF), low byte first
//   record: six i16 big-endian, gages G0 G2 G4 G1 G3 G5 | bit 7 status error, bits 6-0 sum of the 12 bytes modulo 128
//   force = matrix * gages / counts per unit
// The sum is weak (bit 7 of a byte does not show in it): range, jumps and the records behind it must agree too.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "hil/base/result.h"

namespace forcegate::ati {

inline constexpr std::size_t kGageRecordSize = 13;
inline constexpr int kCalibrationRegister = 0x00E3, kCalibrationStride = 192, kCalibrationWords = 168;
inline constexpr int kGainRegister = 0x0000, kStatusRegister = 0x001D;

std::vector<std::uint8_t> encode_frame(std::uint8_t slave, std::uint8_t function,
                                       std::span<const std::uint8_t> data);
/// Function 3. At most 125 registers.
std::vector<std::uint8_t> encode_read(std::uint8_t slave, int address, int count);
/// Function 16.
std::vector<std::uint8_t> encode_write(std::uint8_t slave, int address, std::span<const std::uint16_t> words);

/// Data behind slave and function of a whole, undamaged reply; the error names what is wrong with it.
Result<std::vector<std::uint8_t>> decode_frame(std::span<const std::uint8_t> bytes, std::uint8_t slave,
                                               std::uint8_t function);

struct DigitalCalibration {
  std::string serial, part;
  std::array<std::array<double, 6>, 6> matrix{};  ///< counts per gage count; rows Fx Fy Fz Tx Ty Tz
  double newtons_per_unit = 0.0;
  double counts_per_force = 0.0;
  std::array<std::uint16_t, 12> gains_and_offsets{};
};
/// 168 registers. Refuses units, scales and matrices that cannot be.
Result<DigitalCalibration> decode_calibration(std::span<const std::uint16_t> words);

struct GageRecord {
  bool status_error = false;
  std::array<std::int16_t, 6> gage{};  ///< G0 ... G5
};
enum class GageParse { value, invalid, need_more };
/// Front of a stream whose first byte begins a record.
GageParse parse_gages(std::span<const std::uint8_t> stream, GageRecord& out);

/// N, of the axis 0 (Fx) to 2 (Fz).
double gage_force_N(const DigitalCalibration& calibration, const GageRecord& record, std::size_t axis);

}  // namespace forcegate::ati
