#include "adapters/link/messages.h"

#include <algorithm>
#include <bit>

#include "hil/base/text.h"

namespace forcegate::link {
namespace {

class Writer {
 public:
  Writer& u8(std::uint8_t v) {
    out.push_back(v);
    return *this;
  }
  Writer& u16(std::uint16_t v) {
    return u8(static_cast<std::uint8_t>(v)).u8(static_cast<std::uint8_t>(v >> 8));
  }
  Writer& u32(std::uint32_t v) {
    return u16(static_cast<std::uint16_t>(v)).u16(static_cast<std::uint16_t>(v >> 16));
  }
  Writer& f32(float v) { return u32(std::bit_cast<std::uint32_t>(v)); }
  std::vector<std::uint8_t> out;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  std::uint8_t u8() {
    if (at_ >= bytes_.size()) {
      good_ = false;
      return 0;
    }
    return bytes_[at_++];
  }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | static_cast<unsigned>(u8()) << 8);
  }
  std::uint32_t u32() {
    const std::uint32_t low = u16();
    return low | static_cast<std::uint32_t>(u16()) << 16;
  }
  float f32() { return std::bit_cast<float>(u32()); }
  std::string text(std::size_t size) {
    std::string s;
    for (std::size_t i = 0; i < size; ++i) s.push_back(static_cast<char>(u8()));
    s.resize(std::min(s.find('\0'), s.size()));
    return printable_utf8(s);
  }
  bool finished() const { return good_ && at_ == bytes_.size(); }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace

CalWire to_wire(const Calibration& c) {
  CalWire w{static_cast<float>(c.gain_N_per_V),
            static_cast<float>(c.offset_N),
            static_cast<float>(c.v_range_V),
            static_cast<float>(c.b_scale),
            static_cast<float>(c.q_scale),
            static_cast<std::uint8_t>(c.adc_bits),
            {}};
  std::copy_n(c.id.begin(), std::min(c.id.size(), w.id.size()), w.id.begin());
  return w;
}

std::string_view nak_text(std::uint8_t code) {
  switch (code) {
    case 1: return "unknown type";
    case 2: return "malformed payload";
    case 3: return "protocol major";
    case 4: return "calibration out of range";
    case 5: return "index";
    case 6: return "unknown parameter";
    default: return "unknown code";
  }
}

std::vector<std::uint8_t> hello_payload(std::uint32_t nonce) { return Writer{}.u32(nonce).out; }

std::vector<std::uint8_t> set_cal_payload(const CalWire& c) {
  Writer w;
  w.u8(1)
      .u8(1)
      .f32(c.gain_N_per_V)
      .f32(c.offset_N)
      .f32(c.v_range_V)
      .f32(c.b_scale)
      .f32(c.q_scale)
      .u8(c.adc_bits);
  for (const char ch : c.id) w.u8(static_cast<std::uint8_t>(ch));
  return w.out;
}

std::vector<std::uint8_t> stream_payload(bool run, std::uint16_t divider, std::uint8_t batch) {
  return Writer{}.u8(run ? 1 : 0).u16(divider).u8(batch).out;
}

std::vector<std::uint8_t> time_payload(std::uint64_t host) {
  return Writer{}.u32(static_cast<std::uint32_t>(host)).u32(static_cast<std::uint32_t>(host >> 32)).out;
}

std::vector<std::uint8_t> inject_payload(std::uint32_t first_index, std::span<const std::uint16_t> adc) {
  Writer w;
  w.u32(first_index).u8(static_cast<std::uint8_t>(adc.size()));
  for (const std::uint16_t code : adc) w.u16(code);
  return w.out;
}

std::optional<Info> decode_info(std::span<const std::uint8_t> payload) {
  static constexpr char kHex[] = "0123456789abcdef";
  Reader r(payload);
  Info info;
  info.request = r.u16();
  info.nonce = r.u32();
  info.adc_bits = r.u8();
  info.rate_Hz = r.u16();
  info.batch_max = r.u8();
  info.capabilities = r.u32();
  for (int i = 0; i < 20; ++i) {
    const std::uint8_t byte = r.u8();
    info.build_id.push_back(kHex[byte >> 4]);
    info.build_id.push_back(kHex[byte & 15]);
  }
  info.board = r.text(24);
  info.algorithm_id = r.text(32);
  if (!r.finished() || info.batch_max == 0) return std::nullopt;
  return info;
}

std::optional<Samples> decode_samples(std::span<const std::uint8_t> payload) {
  Reader r(payload);
  Samples s;
  s.request = r.u16();
  s.first_index = r.u32();
  const std::size_t n = r.u8();
  s.dropped = r.u16();
  s.bad = r.u16();
  s.sample.resize(n);
  for (Sample& sample : s.sample) {
    sample.adc = r.u16();
    sample.force_N = r.f32();
    sample.flags = r.u8();
  }
  if (!r.finished() || n == 0) return std::nullopt;
  return s;
}

std::optional<Nak> decode_nak(std::span<const std::uint8_t> payload) {
  Reader r(payload);
  Nak nak;
  nak.request = r.u16();
  nak.code = r.u8();
  nak.type = r.u8();
  if (!r.finished()) return std::nullopt;
  return nak;
}

std::optional<StreamState> decode_stream_state(std::span<const std::uint8_t> payload) {
  Reader r(payload);
  StreamState state;
  state.request = r.u16();
  const std::uint8_t run = r.u8();
  r.u16();  // divider
  r.u8();   // batch
  if (!r.finished() || run > 1) return std::nullopt;
  state.running = run == 1;
  return state;
}

std::optional<TimeReply> decode_time_reply(std::span<const std::uint8_t> payload) {
  Reader r(payload);
  TimeReply reply;
  reply.request = r.u16();
  reply.host = r.u32();
  reply.host |= static_cast<std::uint64_t>(r.u32()) << 32;
  if (!r.finished()) return std::nullopt;
  return reply;
}

std::optional<ParamValue> decode_param_value(std::span<const std::uint8_t> payload) {
  Reader r(payload);
  ParamValue v;
  v.request = r.u16();
  const std::uint8_t parameter = r.u8();
  CalWire& c = v.calibration;
  c.gain_N_per_V = r.f32();
  c.offset_N = r.f32();
  c.v_range_V = r.f32();
  c.b_scale = r.f32();
  c.q_scale = r.f32();
  c.adc_bits = r.u8();
  for (char& ch : c.id) ch = static_cast<char>(r.u8());
  if (!r.finished() || parameter != 1) return std::nullopt;
  return v;
}

}  // namespace forcegate::link
