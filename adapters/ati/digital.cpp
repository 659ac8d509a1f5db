#include "adapters/ati/digital.h"

#include <bit>
#include <cmath>

#include "hil/base/text.h"

namespace forcegate::ati {
namespace {

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t b : bytes) {
    crc ^= b;
    for (int i = 0; i < 8; ++i) crc = (crc & 1U) != 0 ? crc >> 1 ^ 0xA001U : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

void put(std::vector<std::uint8_t>& out, int word) {
  out.push_back(static_cast<std::uint8_t>(word >> 8));
  out.push_back(static_cast<std::uint8_t>(word));
}

std::uint32_t long_at(std::span<const std::uint16_t> words, std::size_t at) {
  return static_cast<std::uint32_t>(words[at]) << 16 | words[at + 1];
}

std::string text_at(std::span<const std::uint16_t> words, std::size_t at, std::size_t count) {
  std::string out;
  for (std::size_t i = at; i < at + count; ++i)
    for (const char c : {static_cast<char>(words[i] >> 8), static_cast<char>(words[i] & 0xFF)})
      if (c != 0) out.push_back(c);
  return printable_utf8(trim(out));
}

// Force units of the calibration block: 1 lb, 2 N, 3 klb, 4 kN, 5 kgf, 6 gf.
constexpr double kNewtons[] = {0.0, 4.4482216152605, 1.0, 4448.2216152605, 1000.0, 9.80665, 9.80665e-3};

}  // namespace

std::vector<std::uint8_t> encode_frame(std::uint8_t slave, std::uint8_t function,
                                       std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> out;
  out.reserve(data.size() + 4);
  out.push_back(slave);
  out.push_back(function);
  out.insert(out.end(), data.begin(), data.end());
  const std::uint16_t crc = crc16(out);
  out.push_back(static_cast<std::uint8_t>(crc));
  out.push_back(static_cast<std::uint8_t>(crc >> 8));
  return out;
}

std::vector<std::uint8_t> encode_read(std::uint8_t slave, int address, int count) {
  std::vector<std::uint8_t> data;
  put(data, address);
  put(data, count);
  return encode_frame(slave, 3, data);
}

std::vector<std::uint8_t> encode_write(std::uint8_t slave, int address,
                                       std::span<const std::uint16_t> words) {
  std::vector<std::uint8_t> data;
  put(data, address);
  put(data, static_cast<int>(words.size()));
  data.push_back(static_cast<std::uint8_t>(2 * words.size()));
  for (const std::uint16_t w : words) put(data, w);
  return encode_frame(slave, 16, data);
}

Result<std::vector<std::uint8_t>> decode_frame(std::span<const std::uint8_t> b, std::uint8_t slave,
                                               std::uint8_t function) {
  const auto wrong = [](std::string what) { return fail(ErrorCode::device, "the sensor's answer " + what); };
  if (b.size() < 5) return wrong("is too short");
  const std::uint16_t crc = crc16(b.first(b.size() - 2));
  if (b[b.size() - 2] != (crc & 0xFFU) || b[b.size() - 1] != crc >> 8) return wrong("is damaged");
  if (b[0] != slave) return wrong("comes from slave " + std::to_string(b[0]));
  if (b[1] == (function | 0x80U)) return wrong("is the exception " + std::to_string(b[2]));
  if (b[1] != function) return wrong("belongs to another request");
  return std::vector<std::uint8_t>(b.begin() + 2, b.end() - 2);
}

Result<DigitalCalibration> decode_calibration(std::span<const std::uint16_t> w) {
  const auto wrong = [](const char* what) {
    return fail(ErrorCode::device, std::string("the sensor's calibration has ") + what, {},
                "choose a calibration that exists (calibration_index)");
  };
  if (w.size() != static_cast<std::size_t>(kCalibrationWords)) return wrong("another length");
  DigitalCalibration c;
  c.serial = text_at(w, 0, 4);
  c.part = text_at(w, 4, 16);
  bool any = false;
  for (std::size_t row = 0; row < 6; ++row)
    for (std::size_t column = 0; column < 6; ++column) {
      const float value = std::bit_cast<float>(long_at(w, 32 + 2 * (6 * row + column)));
      if (!std::isfinite(value) || std::fabs(value) > 1e12F)
        return wrong("a matrix with something that is no number");
      c.matrix[row][column] = static_cast<double>(value);
      any = any || (row < 3 && value != 0.0F);
    }
  if (!any) return wrong("an empty matrix");
  const unsigned unit = w[104] >> 8;
  if (unit < 1 || unit > 6) return wrong("no known unit of force");
  c.newtons_per_unit = kNewtons[unit];
  const auto counts = static_cast<std::int32_t>(long_at(w, 117));
  if (counts <= 0) return wrong("no counts per force");
  c.counts_per_force = counts;
  for (std::size_t i = 0; i < 12; ++i) c.gains_and_offsets[i] = w[121 + i];
  return c;
}

GageParse parse_gages(std::span<const std::uint8_t> b, GageRecord& out) {
  if (b.size() < kGageRecordSize) return GageParse::need_more;
  unsigned sum = 0;
  for (std::size_t i = 0; i < 12; ++i) sum += b[i];
  if ((sum & 0x7FU) != (b[12] & 0x7FU)) return GageParse::invalid;
  out.status_error = (b[12] & 0x80U) != 0;
  static constexpr std::size_t kOrder[] = {0, 2, 4, 1, 3, 5};
  for (std::size_t i = 0; i < 6; ++i)
    out.gage[kOrder[i]] = static_cast<std::int16_t>(static_cast<std::uint16_t>(b[2 * i] << 8 | b[2 * i + 1]));
  return GageParse::value;
}

double gage_force_N(const DigitalCalibration& c, const GageRecord& r, std::size_t axis) {
  double counts = 0.0;
  for (std::size_t i = 0; i < 6; ++i) counts += c.matrix[axis][i] * r.gage[i];
  return counts / c.counts_per_force * c.newtons_per_unit;
}

}  // namespace forcegate::ati
