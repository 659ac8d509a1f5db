#include "adapters/board/link_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <chrono>

#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr int kAttempts = 3;
constexpr std::size_t kFirstBytes = 16, kMostAtOnce = 65536;
constexpr double kTimeEvery_s = 0.5;  ///< of bench time, while the board streams

}  // namespace

std::string LinkBoard::where() const { return "board: " + (line_ ? line_->name() : std::string("closed")); }

Error LinkBoard::told(const Error& error) const {
  return {ErrorCode::device, error.text, where(), "check cable and power of the sensor board"};
}

Result<DeviceIdentity> LinkBoard::open() {
  close();
  auto line = open_line_();
  if (!line && line.error().code != ErrorCode::device && line.error().code != ErrorCode::io) return Unexpected(line.error());
  if (!line) return Unexpected(told(line.error()));  // a port that is not there: the board is unplugged
  line_ = std::move(*line);
  counters_ = {};
  buffer_.clear();
  first_bytes_.clear();
  bytes_ = frames_ = 0;
  expects_sequence_ = image_loaded_ = false;
  static constexpr std::uint8_t kFlush = 0;  // ends whatever half a frame the board has in its buffer
  if (auto sent = line_->write({&kFlush, 1}, options_.reply_timeout_s); !sent)
    return Unexpected(told(sent.error()));
  FORCEGATE_CHECK_OK(stop());
  FORCEGATE_TRY(const link::Frame reply, ask(link::Type::hello, link::hello_payload(0), link::Type::info));
  const auto info = link::decode_info(reply.payload);
  if (!info) return fail(ErrorCode::device, "the board sends a malformed INFO frame", where());
  return DeviceIdentity{info->board, options_.serial, info->build_id, "", options_.serial_by_file};
}

void LinkBoard::close() noexcept {
  if (line_ && streaming_) (void)send(link::Type::stream, link::stream_payload(false, 1, 1));
  streaming_ = false;
  line_.reset();
}

Result<DutInfo> LinkBoard::load(const DutSession& session) {
  FORCEGATE_CHECK_OK(stop());
  counters_ = {};
  image_loaded_ = true;
  FORCEGATE_TRY(const link::Frame reply,
                ask(link::Type::hello, link::hello_payload(session.nonce), link::Type::info));
  const auto info = link::decode_info(reply.payload);
  if (!info) return fail(ErrorCode::firmware, "the board sends a malformed INFO frame", where());
  const link::CalWire calibration = link::to_wire(session.calibration);
  FORCEGATE_TRY(const link::Frame value,
                ask(link::Type::param, link::set_cal_payload(calibration), link::Type::param_value));
  const auto echoed = link::decode_param_value(value.payload);
  FORCEGATE_CHECK_OK(check_echo({reply.version >> 4, info->nonce, echoed && echoed->calibration == calibration,
                                 static_cast<double>(info->rate_Hz)},
                                session, "the board", where()));
  FORCEGATE_CHECK_OK(ask(link::Type::reset, {}, link::Type::reset_done));
  return DutInfo{
      reply.version >> 4, reply.version & 15, info->board,          info->build_id,
      info->algorithm_id, info->nonce,        calibration.adc_bits, static_cast<double>(info->rate_Hz)};
}

Result<void> LinkBoard::start() {
  const auto batch = static_cast<std::uint8_t>(std::clamp(options_.batch, 1, 32));
  FORCEGATE_TRY(const link::Frame reply,
                ask(link::Type::stream, link::stream_payload(true, 1, batch), link::Type::stream_state));
  const auto state = link::decode_stream_state(reply.payload);
  if (!state || !state->running)
    return fail(ErrorCode::device, "the board does not start its stream", where());
  stream_request_ = state->request;
  streaming_ = true;
  next_index_ = 0;
  device_dropped_ = device_bad_ = 0;
  lost_frames_seen_ = counters_.frames_bad + counters_.frames_dropped;
  clock_.clear();
  asked_s_ = -1e9;
  turns_ = 0;
  return {};
}

Result<void> LinkBoard::stop() {
  streaming_ = false;
  FORCEGATE_TRY(const link::Frame reply,
                ask(link::Type::stream, link::stream_payload(false, 1, 1), link::Type::stream_state));
  const auto state = link::decode_stream_state(reply.payload);
  if (!state || state->running) return fail(ErrorCode::device, "the board does not stop its stream", where());
  return {};
}

Result<void> LinkBoard::poll(std::vector<BoardSample>& out) {
  if (!line_) return fail(ErrorCode::device, "the board is not open", where());
  FORCEGATE_CHECK_OK(receive(0.0));
  for (;;) {
    link::ParseResult parsed = link::parse(buffer_);
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(parsed.consumed));
    if (parsed.kind == link::Parse::need_more) break;
    if (parsed.kind == link::Parse::invalid) {
      ++counters_.frames_bad;
      continue;
    }
    FORCEGATE_CHECK_OK(note(parsed.frame));
    if (parsed.frame.type == static_cast<std::uint8_t>(link::Type::samples))
      FORCEGATE_CHECK_OK(take(parsed.frame, out));
    if (parsed.frame.type == static_cast<std::uint8_t>(link::Type::time_reply)) take_time(parsed.frame);
  }
  // Last, so that in virtual time the answer always comes with the next look.
  if (streaming_ && world_.now_s() - asked_s_ >= kTimeEvery_s) return ask_time();
  return {};
}

// A board that does not know TIME answers NAK, which nobody waits for.
Result<void> LinkBoard::ask_time() {
  asked_s_ = world_.now_s();
  time_request_ = sequence_;
  time_open_ = true;
  return send(link::Type::time, link::time_payload(static_cast<std::uint64_t>(asked_s_ * 1e6)));
}

void LinkBoard::take_time(const link::Frame& frame) {
  const auto reply = link::decode_time_reply(frame.payload);
  if (!reply || !time_open_ || reply->request != time_request_) return;
  time_open_ = false;
  if (frame.t_us < last_us_ && clock_.fit().exchanges > 0) ++turns_;
  last_us_ = frame.t_us;
  const double device_s = 1e-6 * static_cast<double>((turns_ << 32) + frame.t_us);
  clock_.add(asked_s_, device_s, world_.now_s());
}

Result<void> LinkBoard::take(const link::Frame& frame, std::vector<BoardSample>& out) {
  const auto samples = link::decode_samples(frame.payload);
  if (!samples) return fail(ErrorCode::firmware, "the board sends a malformed SAMPLES frame", where());
  if (!streaming_ || samples->request != stream_request_) {
    ++foreign_;  // of a stream that was stopped before
    return {};
  }
  if (samples->first_index < next_index_) {
    ++repeats_;
    return {};
  }
  const std::uint64_t lost_frames = counters_.frames_bad + counters_.frames_dropped;
  const bool wire_lost = lost_frames != lost_frames_seen_ || samples->dropped != device_dropped_ || samples->bad != device_bad_;
  lost_frames_seen_ = lost_frames;
  if (samples->first_index > next_index_ && !wire_lost)
    return fail(ErrorCode::firmware,
                "the board leaves out " + std::to_string(samples->first_index - next_index_) + " samples from sample " +
                    std::to_string(next_index_) + " on: its frames follow each other without a gap, none was damaged and it counts none as dropped",
                where(), "look for what its firmware skips");
  counters_.indices_lost += samples->first_index - next_index_;
  std::uint32_t index = samples->first_index;
  for (const link::Sample& s : samples->sample) {
    if (s.adc >> options_.adc_bits != 0) return wider(s.adc);
    out.push_back({index++, s.adc, s.force_N, s.flags});
  }
  next_index_ = index;
  counters_.samples += samples->sample.size();
  device_dropped_ = samples->dropped;
  device_bad_ = samples->bad;
  return {};
}

// Before the image is loaded nothing has been judged, and the bench file is what is wrong. Later it may be the image's own doing.
Unexpected LinkBoard::wider(std::uint16_t code) const {
  return fail(image_loaded_ ? ErrorCode::device : ErrorCode::config,
              "the board sends code " + std::to_string(code) + ", adc_bits = " + std::to_string(options_.adc_bits) + " ends at " +
                  std::to_string((1U << options_.adc_bits) - 1U),
              where(), "enter the width of the board's converter: adc_bits of [board], " + std::to_string(std::bit_width(code)) + " or more");
}

DutCounters LinkBoard::counters() const {
  DutCounters c = counters_;
  c.frames_dropped += device_dropped_;
  c.frames_bad += device_bad_;
  return c;
}

std::map<std::string, std::uint64_t> LinkBoard::counts() const {
  const DutCounters c = counters();
  return {{"damaged frames", c.frames_bad},
          {"lost frames", c.frames_dropped},
          {"lost samples", c.indices_lost},
          {"repeated frames", repeats_},
          {"foreign frames", foreign_}};
}

Result<void> LinkBoard::send(link::Type type, const std::vector<std::uint8_t>& payload) {
  link::Frame frame;
  frame.type = static_cast<std::uint8_t>(type);
  frame.sequence = sequence_++;
  frame.payload = payload;
  if (auto sent = line_->write(link::encode(frame), options_.reply_timeout_s); !sent)
    return Unexpected(told(sent.error()));
  return {};
}

Result<bool> LinkBoard::receive(double timeout_s) {
  bool any = false;
  for (;;) {
    std::uint8_t bytes[4096];
    const auto n = line_->read(bytes, any ? 0.0 : timeout_s);
    if (!n) return Unexpected(told(n.error()));
    if (*n == 0) return any;
    any = true;
    buffer_.insert(buffer_.end(), bytes, bytes + *n);
    bytes_ += *n;
    for (std::size_t i = 0; i < *n && first_bytes_.size() < kFirstBytes; ++i) first_bytes_ += static_cast<char>(bytes[i]);
    if (buffer_.size() > kMostAtOnce) return any;  // of a line that is never still
  }
}

// Sequence numbers count the frames of one direction; a gap is a lost frame.
Result<void> LinkBoard::note(const link::Frame& frame) {
  ++frames_;
  // Before load() the board may run anything: what is judged is flashed first.
  if (image_loaded_ && frame.version >> 4 != link::kVersion >> 4)
    return fail(ErrorCode::firmware, "the board speaks an unknown protocol major " + std::to_string(frame.version >> 4), where());
  if (expects_sequence_) {
    const auto gap = static_cast<std::uint16_t>(frame.sequence - expected_sequence_);
    if (gap < 0x8000) counters_.frames_dropped += gap;
  }
  expects_sequence_ = true;
  expected_sequence_ = static_cast<std::uint16_t>(frame.sequence + 1);
  if (frame.type == static_cast<std::uint8_t>(link::Type::event)) ++counters_.overruns;
  return {};
}

Result<link::Frame> LinkBoard::ask(link::Type type, const std::vector<std::uint8_t>& payload,
                                   link::Type answer) {
  if (!line_) return fail(ErrorCode::device, "the board is not open", where());
  using Clock = std::chrono::steady_clock;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const std::uint16_t request = sequence_;
    FORCEGATE_CHECK_OK(send(type, payload));
    const auto end = Clock::now() + std::chrono::duration<double>(options_.reply_timeout_s);
    while (Clock::now() < end) {
      link::ParseResult parsed = link::parse(buffer_);
      buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(parsed.consumed));
      if (parsed.kind == link::Parse::need_more) {
        FORCEGATE_CHECK_OK(receive(0.05));
        continue;
      }
      if (parsed.kind == link::Parse::invalid) {
        ++counters_.frames_bad;
        continue;
      }
      FORCEGATE_CHECK_OK(note(parsed.frame));
      const std::vector<std::uint8_t>& p = parsed.frame.payload;
      const bool ours =
          p.size() >= 2 && (p[0] | p[1] << 8) == request;  // every answer begins with the request's number
      if (!ours) continue;
      if (parsed.frame.type == static_cast<std::uint8_t>(answer)) return std::move(parsed.frame);
      if (parsed.frame.type != static_cast<std::uint8_t>(link::Type::nak)) continue;
      ++counters_.naks;
      const auto nak = link::decode_nak(p);
      return fail(
          ErrorCode::firmware,
          "the board refuses a request: " + std::string(nak ? link::nak_text(nak->code) : "malformed NAK"),
          where());
    }
  }
  return no_answer();
}

// A board that talks, but not this link, has power and a cable.
Unexpected LinkBoard::no_answer() const {
  if (bytes_ == 0 || frames_ > 0)
    return fail(ErrorCode::timeout, "the board does not answer", where(),
                "check power, cable and baud rate of the sensor board, and that its firmware runs");
  const bool text = std::all_of(first_bytes_.begin(), first_bytes_.end(), [](char c) { return (c >= ' ' && c <= '~') || c == '\r' || c == '\n' || c == '\t'; });
  std::string first;
  for (const char c : first_bytes_) first += text ? std::string(1, c < ' ' ? ' ' : c) : fmt::format("{}{:02x}", first.empty() ? "" : " ", static_cast<unsigned char>(c));
  return fail(ErrorCode::timeout, fmt::format("the board sends bytes (first: {}) but no frame of the link", text ? "\"" + first + "\"" : first), where(),
              "another sketch runs on it than one of docs/protocol.md, or baud of [board] is not its rate");
}

}  // namespace forcegate
