#pragma once
// Payloads of the frames: what the harness says and what it understands. Decoders answer nullopt when a
// payload does not have the layout of docs/protocol.md; they never guess.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/interface/calibration.h"

namespace forcegate::link {

enum class Type : std::uint8_t {
  hello = 0x01,
  stream = 0x02,
  inject = 0x03,
  param = 0x04,
  time = 0x05,
  reset = 0x06,
  echo = 0x07,
  info = 0x81,
  samples = 0x82,
  event = 0x83,
  nak = 0x84,
  param_value = 0x85,
  reset_done = 0x86,
  echo_reply = 0x87,
  time_reply = 0x88,
  stream_state = 0x89,
};

/// CAL as it crosses the link: single precision.
struct CalWire {
  float gain_N_per_V = 0, offset_N = 0, v_range_V = 0, b_scale = 0, q_scale = 0;
  std::uint8_t adc_bits = 0;
  std::array<char, 16> id{};
  bool operator==(const CalWire&) const = default;
};

/// Longer ids are cut to 16 bytes.
CalWire to_wire(const Calibration& calibration);

struct Info {
  std::uint16_t request = 0;
  std::uint32_t nonce = 0;
  std::uint8_t adc_bits = 0;
  std::uint16_t rate_Hz = 0;
  std::uint8_t batch_max = 0;
  std::uint32_t capabilities = 0;  ///< bit 0: INJECT
  std::string build_id;            ///< 40 hex digits
  std::string board, algorithm_id;
};

struct Sample {
  std::uint16_t adc = 0;
  float force_N = 0;
  std::uint8_t flags = 0;
};

struct Samples {
  std::uint16_t request = 0;
  std::uint32_t first_index = 0;
  std::uint16_t dropped = 0,
                bad = 0;  ///< frames that the device could not send, bytes that were no frame to it
  std::vector<Sample> sample;
};

struct Nak {
  std::uint16_t request = 0;
  std::uint8_t code = 0, type = 0;
};

/// "unknown type", "malformed payload", "protocol major", "calibration out of range", "index", "unknown
/// parameter".
std::string_view nak_text(std::uint8_t code);

std::vector<std::uint8_t> hello_payload(std::uint32_t nonce);
std::vector<std::uint8_t> set_cal_payload(const CalWire& calibration);
/// Free-running stream of a board with its own converter: every divider-th sample, batch (1-32) to a frame.
std::vector<std::uint8_t> stream_payload(bool run, std::uint16_t divider, std::uint8_t batch);
/// Any 8 bytes of the host, which the reply echoes.
std::vector<std::uint8_t> time_payload(std::uint64_t host);
/// At most 32 codes.
std::vector<std::uint8_t> inject_payload(std::uint32_t first_index, std::span<const std::uint16_t> adc);

std::optional<Info> decode_info(std::span<const std::uint8_t> payload);
std::optional<Samples> decode_samples(std::span<const std::uint8_t> payload);
std::optional<Nak> decode_nak(std::span<const std::uint8_t> payload);
struct StreamState {
  std::uint16_t request = 0;
  bool running = false;
};
std::optional<StreamState> decode_stream_state(std::span<const std::uint8_t> payload);
struct TimeReply {
  std::uint16_t request = 0;
  std::uint64_t host = 0;
};
std::optional<TimeReply> decode_time_reply(std::span<const std::uint8_t> payload);
struct ParamValue {
  std::uint16_t request = 0;
  CalWire calibration;
};
std::optional<ParamValue> decode_param_value(std::span<const std::uint8_t> payload);

}  // namespace forcegate::link
