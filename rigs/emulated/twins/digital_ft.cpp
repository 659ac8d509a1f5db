#include "rigs/emulated/twins/digital_ft.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace forcegate::emulated {
namespace {

constexpr int kBlock = 0x00E3;
constexpr double kStep = 200.0;           // counts per gage count
constexpr double kCos = 0.8, kSin = 0.6;  // exact in the sum of squares
constexpr std::size_t kJam = 14;

}  // namespace

DigitalFt::DigitalFt(const ReferenceTwinOptions& o, Wire& wire)
    : o_(o),
      wire_(wire),
      calibration_(calibration(o.serial, static_cast<std::int32_t>(std::lround(o.counts_per_N)))) {}

Bytes DigitalFt::record(const Gages& g, bool error) {
  Bytes out;
  for (const std::size_t i : {0U, 2U, 4U, 1U, 3U, 5U}) {
    out.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(g[i]) >> 8));
    out.push_back(static_cast<std::uint8_t>(g[i]));
  }
  unsigned sum = 0;
  for (const std::uint8_t b : out) sum += b;
  out.push_back(static_cast<std::uint8_t>((sum & 0x7FU) | (error ? 0x80U : 0U)));
  return out;
}

// Fz = kStep (cos G2 - sin G3), Tx = kStep (sin G2 + cos G3): the inverse of a rotation is its transpose.
DigitalFt::Gages DigitalFt::gages_of(double counts) {
  const auto rounded = [](double v) {
    return static_cast<std::int16_t>(std::lround(std::clamp(v, -32767.0, 32767.0)));
  };
  return {4, -7, rounded(kCos * counts / kStep), rounded(-kSin * counts / kStep), 11, 2};
}

std::array<std::uint16_t, 168> DigitalFt::calibration(const std::string& serial, std::int32_t counts_per_N) {
  std::array<std::uint16_t, 168> w{};
  const auto text = [&](std::size_t at, std::size_t words, const std::string& s) {
    for (std::size_t i = 0; i < 2 * words && i < s.size(); ++i)
      w[at + i / 2] = static_cast<std::uint16_t>(
          w[at + i / 2] | static_cast<unsigned>(static_cast<unsigned char>(s[i])) << (i % 2 == 0 ? 8 : 0));
  };
  const auto number = [&](std::size_t at, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    w[at] = static_cast<std::uint16_t>(bits >> 16);
    w[at + 1] = static_cast<std::uint16_t>(bits);
  };
  text(0, 4, serial);
  text(4, 16, "SI-20-1");
  text(22, 10, "2026/01/15");
  for (std::size_t pair = 0; pair < 3; ++pair) {  // rows 2p and 2p + 1, gages 2p and 2p + 1
    const std::size_t row = 32 + 2 * (6 * 2 * pair + 2 * pair);
    number(row, static_cast<float>(kStep * kCos));
    number(row + 2, static_cast<float>(-kStep * kSin));
    number(row + 12, static_cast<float>(kStep * kSin));
    number(row + 14, static_cast<float>(kStep * kCos));
  }
  w[104] = 2 << 8 | 3;  // N and Nm
  w[117] = static_cast<std::uint16_t>(static_cast<std::uint32_t>(counts_per_N) >> 16);
  w[118] = static_cast<std::uint16_t>(counts_per_N);
  w[119] = 0x000F;  // 1000000 counts per Nm
  w[120] = 0x4240;
  for (std::size_t i = 0; i < 12; ++i) w[121 + i] = static_cast<std::uint16_t>(i < 6 ? 1000 + i : 2000 + i);
  return w;
}

void DigitalFt::power_cycle() {
  streaming_ = unlocked_ = false;
  active_.fill(0);
}

std::optional<std::uint16_t> DigitalFt::read(int address) {
  if (address >= 0 && address < 12) return active_[static_cast<std::size_t>(address)];
  if (address == 0x000C) return std::uint16_t{1};
  if (address == 0x001D) return std::uint16_t{0};
  if (address == 0x001F) return std::uint16_t{0};
  if (address >= kBlock && address < kBlock + 168)
    return calibration_[static_cast<std::size_t>(address - kBlock)];
  return std::nullopt;
}

int DigitalFt::write(int address, std::uint16_t word) {
  if (address < 0 || address > 11) return 2;
  if (!unlocked_) return 4;
  active_[static_cast<std::size_t>(address)] = word;
  return 0;
}

Bytes DigitalFt::answer(std::span<const std::uint8_t> q) {
  if (q[0] == 0x6A && q.size() == 2) {
    unlocked_ = q[1] == 0xAA;
    return {0x6A, static_cast<std::uint8_t>(q[1] == 0xAA || q[1] == 0x18 ? 1 : 0)};
  }
  if (q[0] == 0x46 && q.size() == 2) {
    // The gains of the calibration must be in use, else the gages mean nothing.
    streaming_ = q[1] == 0x55 && std::equal(active_.begin(), active_.end(), calibration_.begin() + 121);
    next_s_ = 0.0;
    zeros_ = 0;
    return {0x46, static_cast<std::uint8_t>(streaming_ ? 1 : 0)};
  }
  return modbus_reply(*this, q);
}

void DigitalFt::serve(WireEnd& end, double t_s) {
  Bytes& in = end.rest;
  if (streaming_) {
    for (const std::uint8_t b : in) zeros_ = b == 0 ? zeros_ + 1 : 0;
    if (zeros_ >= kJam) streaming_ = false;
    in.clear();
    return;
  }
  while (!in.empty() && in.front() != o_.slave) in.erase(in.begin());  // the rest of a jam
  while (in.size() >= 4) {
    std::size_t length = 0;  // without the checksum
    if (in[1] == 3) length = 6;
    if (in[1] == 16 && in.size() >= 7) length = 7U + in[6];
    if (in[1] == 0x6A || in[1] == 0x46) length = 3;
    if (length == 0 && in[1] != 16) {
      in.clear();
      return;
    }
    if (length == 0 || in.size() < length + 2) return;
    const std::uint16_t crc = modbus_crc16({in.data(), length});
    const bool sound = in[length] == (crc & 0xFFU) && in[length + 1] == crc >> 8;
    const Bytes request(in.begin() + 1, in.begin() + static_cast<std::ptrdiff_t>(length));
    in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(length + 2));
    if (!sound) {
      in.clear();
      return;
    }
    Bytes reply{static_cast<std::uint8_t>(o_.slave)};
    const Bytes body = answer(request);
    reply.insert(reply.end(), body.begin(), body.end());
    const std::uint16_t sum = modbus_crc16(reply);
    reply.push_back(static_cast<std::uint8_t>(sum));
    reply.push_back(static_cast<std::uint8_t>(sum >> 8));
    wire_.send(&end, std::move(reply), t_s);
  }
}

void DigitalFt::row(double t_s, double force_N, bool saturated) {
  const bool frozen = wire_.faults().active("reference", WireFault::frozen, t_s);
  if (frozen && !was_frozen_) frozen_N_ = force_N;
  was_frozen_ = frozen;
  if (!streaming_) return;
  if (next_s_ <= 0.0 || next_s_ < t_s - 1.0) next_s_ = t_s;
  if (t_s + 1e-9 < next_s_) return;
  next_s_ += 1.0 / o_.rate_Hz;
  saturated = saturated || wire_.faults().active("reference", WireFault::saturation, t_s);
  const Gages gages = saturated ? Gages{4, -7, 32767, -32767, 11, 2}
                                : gages_of((frozen ? frozen_N_ : force_N) * o_.counts_per_N);
  wire_.send(nullptr, record(gages, saturated), t_s);
}

}  // namespace forcegate::emulated
