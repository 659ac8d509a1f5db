// Lane "uart": the Cortex-M image with its real link protocol over the PL011 of an emulated LM3S6965 board,
// through a Unix socket. Every sample crosses the link twice; sequence numbers and indices make any loss
// visible.

#include <array>
#include <cmath>

#include "adapters/emulator/answer_wait.h"
#include "adapters/emulator/qemu.h"
#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "adapters/transport/unix_socket.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

constexpr double kTimeout_s = 20.0;
constexpr std::size_t kInFlight = 2;

class UartDut final : public Dut {
 public:
  UartDut(std::string program, double timeout_s) : program_(std::move(program)), timeout_s_(timeout_s) {}
  ~UartDut() override { stop(); }

  Result<DutInfo> open(const DutSession& session) override {
    stop();
    counters_ = {};
    stream_.clear();
    sequence_ = 0;
    expects_sequence_ = false;
    session_rate_Hz_ = session.rate_Hz;
    device_dropped_ = device_bad_ = 0;
    where_ = printable_utf8(session.image.string());
    FORCEGATE_TRY(const link::Image image, link::inspect_image(session.image));
    FORCEGATE_CHECK_OK(link::check_whole(image, where_));
    if (image.port != "uart" || image.board.empty())
      return fail(ErrorCode::usage, "the image is not built for the uart port", where_,
                  "link rigs/firmware/ports/uart_lm3s6965.c, or choose the lane " +
                      (image.port.empty() ? std::string("that the image was built for") : image.port));
    FORCEGATE_CHECK_OK(qemu_.make_folder());
    const std::filesystem::path path = qemu_.folder() / "uart";
    FORCEGATE_TRY(UnixListener listener, UnixListener::listen_at(path));
    FORCEGATE_CHECK_OK(qemu_.start(
        program_, image.board, session.image,
        {"-chardev", "socket,id=uart,path=" + path.string() + ",server=off", "-serial", "chardev:uart"}));
    FORCEGATE_TRY(transport_, listener.accept_peer(timeout_s_));
    if (transport_ == nullptr)
      return Unexpected(qemu_.dead() ? qemu_.death(where_) : Error{ErrorCode::timeout, "the emulator does not connect its serial port within " + shortest(timeout_s_) + " s", where_, {}});
    FORCEGATE_CHECK_OK(receive(link::Type::info));  // the device speaks first
    FORCEGATE_TRY(DutInfo info, handshake(session));
    FORCEGATE_CHECK_OK(link::check_build_id(image, info.build_id, where_));
    resources_ = {};
    resources_.ram_bytes = image.ram_bytes;
    resources_.flash_bytes = image.flash_bytes;
    return info;
  }

  DutResources resources() const override { return resources_; }

  Result<DutInfo> restart(const DutSession& session) override {
    if (transport_ == nullptr) return open(session);
    counters_.samples = 0;
    return handshake(session);
  }

  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    std::size_t sent = 0, done = 0;
    while (done < adc.size()) {
      while (sent < adc.size() && sent - done < kInFlight * batch_) {
        const std::size_t n = std::min(batch_, adc.size() - sent);
        FORCEGATE_CHECK_OK(
            send(link::Type::inject,
                 link::inject_payload(first_index + static_cast<std::uint32_t>(sent), adc.subspan(sent, n))));
        sent += n;
      }
      FORCEGATE_TRY(const link::Frame frame, receive(link::Type::samples));
      const auto samples = link::decode_samples(frame.payload);
      if (!samples) return fail(ErrorCode::firmware, "the image sends a malformed SAMPLES frame", where_);
      const std::uint32_t expected = first_index + static_cast<std::uint32_t>(done);
      if (samples->first_index != expected || done + samples->sample.size() > sent) {
        counters_.indices_lost += samples->first_index - expected;
        return fail(ErrorCode::firmware,
                    "samples were lost on the link: expected index " + std::to_string(expected) + ", got " +
                        std::to_string(samples->first_index),
                    where_);
      }
      for (const link::Sample& s : samples->sample) {
        if (s.adc != adc[done])
          return fail(ErrorCode::firmware,
                      "the image echoes another code than it was given at sample " +
                          std::to_string(first_index + done),
                      where_);
        force_N[done] = s.force_N;
        flags[done] = s.flags;
        ++done;
      }
      FORCEGATE_CHECK_OK(
          check_clock(frame.t_us, first_index + static_cast<std::uint32_t>(done), session_rate_Hz_));
      device_dropped_ = samples->dropped;
      device_bad_ = samples->bad;
    }
    counters_.samples += adc.size();
    return {};
  }

  Result<DutCounters> close() override {
    stop();
    DutCounters counters = counters_;
    counters.frames_dropped += device_dropped_;
    counters.frames_bad += device_bad_;
    return counters;
  }

 private:
  static constexpr const char* kSilent = "look for an endless loop, or for a UART that was never enabled";

  Result<DutInfo> handshake(const DutSession& session) {
    FORCEGATE_CHECK_OK(send(link::Type::hello, link::hello_payload(session.nonce)));
    FORCEGATE_TRY(const link::Frame reply, receive(link::Type::info));
    const auto info = link::decode_info(reply.payload);
    if (!info) return fail(ErrorCode::firmware, "the image sends a malformed INFO frame", where_);
    if ((info->capabilities & 1U) == 0)
      return fail(ErrorCode::firmware, "the image cannot take injected samples (capability INJECT)", where_);
    const link::CalWire calibration = link::to_wire(session.calibration);
    FORCEGATE_CHECK_OK(send(link::Type::param, link::set_cal_payload(calibration)));
    FORCEGATE_TRY(const link::Frame value, receive(link::Type::param_value));
    const auto echoed = link::decode_param_value(value.payload);
    FORCEGATE_CHECK_OK(check_echo({reply.version >> 4, info->nonce, echoed && echoed->calibration == calibration,
                                   static_cast<double>(info->rate_Hz)},
                                  session, "the image", where_));
    FORCEGATE_CHECK_OK(probe());
    FORCEGATE_CHECK_OK(send(link::Type::reset, {}));
    FORCEGATE_CHECK_OK(receive(link::Type::reset_done));
    clock_known_ = false;
    batch_ = std::min<std::size_t>(info->batch_max, 32);
    return DutInfo{
        reply.version >> 4, reply.version & 15, info->board,          info->build_id,
        info->algorithm_id, info->nonce,        calibration.adc_bits, static_cast<double>(info->rate_Hz)};
  }

  // A few requests that a device must refuse or bear, before any sample counts. What they leave behind is for
  // RESET to forget: an image that ignores RESET is at another index afterwards.
  Result<void> probe() {
    const std::vector<std::uint8_t> odd{0, 0xFF, 0, 0, 1, 0xFE, 0x55, 0}, marker{'o', 'k'};
    FORCEGATE_CHECK_OK(send(link::Type{0x7E}, {}));
    FORCEGATE_CHECK_OK(expect_nak(1, "an unknown request"));
    FORCEGATE_CHECK_OK(send(link::Type::inject, link::inject_payload(7, std::array<std::uint16_t, 1>{1000})));
    FORCEGATE_CHECK_OK(expect_nak(5, "samples that do not continue"));
    FORCEGATE_CHECK_OK(send(link::Type::echo, odd));
    FORCEGATE_TRY(const link::Frame echo, receive(link::Type::echo_reply));
    if (echo.payload != odd)
      return fail(ErrorCode::firmware, "the image does not echo the bytes it was sent", where_);
    link::Frame damaged;
    damaged.type = static_cast<std::uint8_t>(link::Type::echo);
    damaged.sequence = sequence_;  // not counted on: a sound device never saw it
    damaged.payload = odd;
    std::vector<std::uint8_t> bytes = link::encode(damaged);
    bytes[bytes.size() - 2] ^= bytes[bytes.size() - 2] == 0x40 ? 0x20 : 0x40;  // in the CRC, not made zero
    FORCEGATE_CHECK_OK(write(bytes));
    FORCEGATE_CHECK_OK(send(link::Type::echo, marker));
    FORCEGATE_TRY(const link::Frame next, receive(link::Type::echo_reply));
    if (next.payload != marker)
      return fail(ErrorCode::firmware, "the image accepts a frame whose CRC is wrong", where_);
    const std::array<std::uint16_t, 8> codes{0, 65535, 1, 30000, 30001, 2, 3, 4};
    FORCEGATE_CHECK_OK(send(link::Type::inject, link::inject_payload(0, codes)));
    FORCEGATE_CHECK_OK(receive(link::Type::samples));
    return {};
  }

  Result<void> expect_nak(std::uint8_t code, const char* what) {
    const std::vector<std::uint8_t> marker{'n'};
    FORCEGATE_CHECK_OK(send(link::Type::echo, marker));  // comes back even if the request was ignored
    FORCEGATE_TRY(const link::Frame reply, receive(link::Type::nak, link::Type::echo_reply));
    const auto nak = link::decode_nak(reply.payload);
    if (reply.type != static_cast<std::uint8_t>(link::Type::nak) || !nak || nak->code != code)
      return fail(ErrorCode::firmware, std::string("the image does not refuse ") + what, where_);
    FORCEGATE_CHECK_OK(receive(link::Type::echo_reply));
    return {};
  }

  // With injected samples the sample count is the clock (docs/protocol.md); 100 ppm and a millisecond are
  // allowed.
  Result<void> check_clock(std::uint32_t t_us, std::uint32_t next_index, double rate_Hz) {
    if (!clock_known_) {
      clock_known_ = true;
      clock_t_us_ = t_us;
      clock_index_ = next_index;
      return {};
    }
    const double expected_us = 1e6 * static_cast<double>(next_index - clock_index_) / rate_Hz;
    const auto whole = static_cast<std::uint32_t>(static_cast<std::uint64_t>(expected_us));
    const auto off_us = static_cast<double>(static_cast<std::int32_t>(t_us - clock_t_us_ - whole));
    if (std::abs(off_us) <= 1000.0 + 1e-4 * expected_us) return {};
    return fail(ErrorCode::firmware,
                "the device clock is " + shortest(off_us / 1000.0) + " ms off after " +
                    shortest(expected_us / 1e6) + " s of samples",
                where_, "t_us counts microseconds and wraps at 2^32");
  }

  Result<void> write(const std::vector<std::uint8_t>& bytes) {
    auto sent = transport_->write(bytes, timeout_s_);
    if (sent) return {};
    // The emulator takes bytes off its socket whatever the image does; what it does not take is not the image's.
    return Unexpected(qemu_.dead() ? qemu_.death(where_) : Error{ErrorCode::timeout, "the emulator takes no bytes: " + sent.error().text, where_, {}});
  }

  Result<void> send(link::Type type, std::vector<std::uint8_t> payload) {
    link::Frame frame;
    frame.type = static_cast<std::uint8_t>(type);
    frame.sequence = sequence_++;
    frame.payload = std::move(payload);
    return write(link::encode(frame));
  }

  Result<link::Frame> receive(link::Type wanted) { return receive(wanted, wanted); }

  /// The next frame of either type; EVENT frames pass by, a NAK that was not asked for is an error.
  Result<link::Frame> receive(link::Type wanted, link::Type other) {
    AnswerWait wait(qemu_.id(), timeout_s_);
    for (;;) {
      link::ParseResult parsed = link::parse(stream_);
      stream_.erase(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(parsed.consumed));
      if (parsed.kind == link::Parse::value) {
        FORCEGATE_TRY(const bool is_wanted, examine(parsed.frame, wanted, other));
        if (is_wanted) return std::move(parsed.frame);
        continue;
      }
      if (parsed.kind == link::Parse::invalid) {
        ++counters_.frames_bad;
        continue;
      }
      FORCEGATE_CHECK_OK(wait.look(": a frame of type " + std::to_string(static_cast<int>(wanted)) + " is missing, " +
                                       std::to_string(counters_.frames_bad) + " damaged frames",
                                   where_, kSilent));
      std::uint8_t chunk[4096];
      auto n = transport_->read(chunk, 0.1);
      if (!n || (*n == 0 && qemu_.dead())) {
        qemu_.finish(0.5);
        return Unexpected(qemu_.death(where_));
      }
      stream_.insert(stream_.end(), chunk, chunk + *n);
    }
  }

  Result<bool> examine(const link::Frame& frame, link::Type wanted, link::Type other) {
    if (frame.version >> 4 != link::kVersion >> 4)
      return fail(ErrorCode::firmware, "unknown protocol major " + std::to_string(frame.version >> 4),
                  where_);
    if (expects_sequence_ && frame.sequence == static_cast<std::uint16_t>(expected_sequence_ - 1))
      return fail(ErrorCode::firmware,
                  "the image repeats the sequence number " + std::to_string(frame.sequence), where_);
    if (expects_sequence_)
      counters_.frames_dropped += static_cast<std::uint16_t>(frame.sequence - expected_sequence_);
    expects_sequence_ = true;
    expected_sequence_ = static_cast<std::uint16_t>(frame.sequence + 1);
    if (frame.type == static_cast<std::uint8_t>(wanted) || frame.type == static_cast<std::uint8_t>(other))
      return true;
    if (frame.type != static_cast<std::uint8_t>(link::Type::nak)) return false;
    ++counters_.naks;
    const auto nak = link::decode_nak(frame.payload);
    return fail(
        ErrorCode::firmware,
        "the image refuses a request: " + std::string(nak ? link::nak_text(nak->code) : "malformed NAK"),
        where_);
  }

  void stop() {
    transport_.reset();
    qemu_.stop();
  }

  std::string program_, where_;
  double timeout_s_;
  Qemu qemu_;
  std::unique_ptr<Transport> transport_;
  std::vector<std::uint8_t> stream_;
  std::uint16_t sequence_ = 0, expected_sequence_ = 0, device_dropped_ = 0, device_bad_ = 0;
  bool expects_sequence_ = false, clock_known_ = false;
  std::uint32_t clock_t_us_ = 0, clock_index_ = 0;
  double session_rate_Hz_ = 1000.0;
  std::size_t batch_ = 32;
  DutCounters counters_;
  DutResources resources_;
};

const Registration<LaneKind> kRegistered{{
    "uart",
    "The Cortex-M image (uart port) in qemu-system-arm, link protocol over its serial port. Open and closed "
    "loop.",
    [](const std::filesystem::path& path) {
      const auto image = link::inspect_image(path);
      return image && image->port == "uart";
    },
    [](const std::map<std::string, std::string>& options) -> Result<std::unique_ptr<Dut>> {
      FORCEGATE_TRY(QemuOptions given, Qemu::options("uart", options, kTimeout_s));
      return std::make_unique<UartDut>(std::move(given.program), given.timeout_s);
    },
}};

}  // namespace
}  // namespace forcegate
