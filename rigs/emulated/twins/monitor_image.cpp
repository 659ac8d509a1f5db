// What a board answers around its algorithm: the frames of docs/protocol.md except STREAM, which is the board's own.

#include <algorithm>
#include <cmath>

#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "rigs/emulated/twins/native_image.h"

namespace forcegate::emulated {
namespace {

constexpr std::size_t kCalSize = 37;
constexpr std::uint8_t kNak = 0x84;

unsigned hex_digit(char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10) & 15U; }

BoardFrame refusal(const BoardFrame& request, std::uint8_t code) {
  BoardFrame reply;
  reply.type = kNak;
  put_u16(reply.payload, request.sequence);
  reply.payload.push_back(code);
  reply.payload.push_back(request.type);
  return reply;
}

BoardFrame reply_to(const BoardFrame& request, std::uint8_t type) {
  BoardFrame reply;
  reply.type = type;
  put_u16(reply.payload, request.sequence);
  return reply;
}

class Blank final : public MonitorImage {
  bool restart(std::uint32_t nonce, const BoardCalibration& calibration, BoardIdentity& identity) override {
    constexpr std::string_view kName = "blank";
    identity.nonce = nonce;
    identity.calibration = calibration;
    std::copy(kName.begin(), kName.end(), identity.board.begin());
    identity.build_id.fill('0');
    return true;
  }
  bool run(std::uint32_t, std::span<const std::uint16_t> adc, float* force_N, std::uint8_t* flags) override {
    std::fill_n(force_N, adc.size(), 0.0F);
    std::fill_n(flags, adc.size(), std::uint8_t{0});
    return true;
  }
};

}  // namespace

std::optional<BoardFrame> MonitorImage::answer(const BoardFrame& request) {
  BoardIdentity identity;
  switch (request.type) {
    case 0x01: {  // HELLO
      if (request.payload.size() != 4) return refusal(request, 2);
      nonce_ = u32_at(request.payload, 0);
      if (!restart(nonce_, calibration_, identity)) return std::nullopt;
      version_ = identity.version;
      BoardFrame reply = reply_to(request, 0x81);
      reply.version = version_;
      put_u32(reply.payload, identity.nonce);
      reply.payload.push_back(static_cast<std::uint8_t>(calibration_.adc_bits));
      put_u16(reply.payload, identity.rate_Hz);
      reply.payload.push_back(32);
      put_u32(reply.payload, 0);  // a board with its own converter takes no INJECT
      for (std::size_t i = 0; i < 20; ++i)
        reply.payload.push_back(static_cast<std::uint8_t>(hex_digit(identity.build_id[2 * i]) << 4 |
                                                          hex_digit(identity.build_id[2 * i + 1])));
      reply.payload.insert(reply.payload.end(), identity.board.begin(), identity.board.end());
      reply.payload.insert(reply.payload.end(), identity.algorithm.begin(), identity.algorithm.end());
      return reply;
    }
    case 0x04: {  // PARAM
      const Bytes& in = request.payload;
      if (in.size() < 2 || in[0] != 1 || in[1] > 1) return refusal(request, 6);
      if (in[1] == 1) {
        if (in.size() != 2 + kCalSize) return refusal(request, 2);
        BoardCalibration c;
        float* const numbers[5] = {&c.gain_N_per_V, &c.offset_N, &c.v_range_V, &c.b_scale, &c.q_scale};
        for (std::size_t i = 0; i < 5; ++i) *numbers[i] = f32_at(in, 2 + 4 * i);
        c.adc_bits = in[22];
        std::copy(in.begin() + 23, in.begin() + 39, c.id.begin());
        if (!restart(nonce_, c, identity)) return fate().empty() ? std::optional(refusal(request, 4)) : std::nullopt;
        calibration_ = c;
        told_ = identity.calibration;
      }
      BoardFrame reply = reply_to(request, 0x85);
      reply.payload.push_back(1);
      for (const float v : {told_.gain_N_per_V, told_.offset_N, told_.v_range_V, told_.b_scale, told_.q_scale})
        put_f32(reply.payload, v);
      reply.payload.push_back(static_cast<std::uint8_t>(told_.adc_bits));
      reply.payload.insert(reply.payload.end(), told_.id.begin(), told_.id.end());
      return reply;
    }
    case 0x05: {  // TIME
      if (request.payload.size() != 8) return refusal(request, 2);
      BoardFrame reply = reply_to(request, 0x88);
      reply.payload.insert(reply.payload.end(), request.payload.begin(), request.payload.end());
      return reply;
    }
    case 0x06:  // RESET
      if (!restart(nonce_, calibration_, identity)) return std::nullopt;
      return reply_to(request, 0x86);
    case 0x07: {  // ECHO
      BoardFrame reply;
      reply.type = 0x87;
      reply.payload = request.payload;
      return reply;
    }
    default: return refusal(request, 1);
  }
}

std::optional<Bytes> MonitorImage::convert(std::uint32_t first_index, std::span<const std::uint16_t> adc) {
  std::vector<float> force_N(adc.size());
  std::vector<std::uint8_t> flags(adc.size());
  if (!run(first_index, adc, force_N.data(), flags.data())) return std::nullopt;
  Bytes out;
  put_u32(out, first_index);
  out.push_back(static_cast<std::uint8_t>(adc.size()));
  put_u16(out, 0);
  put_u16(out, 0);
  for (std::size_t i = 0; i < adc.size(); ++i) {
    put_u16(out, adc[i]);
    put_f32(out, force_N[i]);
    out.push_back(flags[i]);
  }
  return out;
}

std::unique_ptr<BoardImage> blank_board() { return std::make_unique<Blank>(); }

Result<std::unique_ptr<BoardImage>> load_image(const std::string& path) {
  FORCEGATE_TRY(const std::string bytes, read_file(path));
  if (bytes.size() < 20 || bytes.compare(0, 4,
                                         "\x7f"
                                         "ELF") != 0)
    return fail(ErrorCode::usage, "this file is no firmware image", path, "give an ELF image");
  constexpr std::uint8_t kArm = 40;
  if (static_cast<std::uint8_t>(bytes[18]) != kArm) return load_native_image(path);
  const std::string marker = "forcegate-port:uart:";
  const std::size_t at = bytes.find(marker);
  if (at == std::string::npos)
    return fail(ErrorCode::usage, "the twin of the board cannot run this ARM image", path,
                "a board needs the image with the uart port, or a shared object");
  const std::size_t begin = at + marker.size();
  return load_uart_image(path, bytes.substr(begin, bytes.find('\0', begin) - begin));
}

}  // namespace forcegate::emulated
