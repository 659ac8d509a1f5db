// Lane "block": the Cortex-M image that ships, in qemu-system-arm, fed through semihosting files that are
// named pipes. Memory stays bounded however long the record is, and a block may be as short as the ten
// samples of a control period.

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <cstring>

#include "adapters/emulator/qemu.h"
#include "adapters/transport/descriptor.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are written as the host has them");

constexpr std::size_t kBlockMax = 4096;
constexpr double kTimeout_s = 20.0;

constexpr std::uint32_t magic(const char (&text)[5]) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(text[i]);
  return value;
}

struct WireCalibration {
  float gain_N_per_V, offset_N, v_range_V, b_scale, q_scale;
  std::uint32_t adc_bits;
  char id[16];
};
struct RequestHeader {
  std::uint32_t magic, version, nonce, rate_Hz;
  WireCalibration calibration;
};
struct AnswerHeader {
  std::uint32_t magic, version, nonce, status, rate_Hz;
  WireCalibration calibration;
  char board[24], build_id[40], algorithm_id[32];
};
struct BlockHead {
  std::uint32_t magic, first_index, n, status;
};
static_assert(sizeof(RequestHeader) == 56 && sizeof(AnswerHeader) == 156 && sizeof(BlockHead) == 16);

template <std::size_t n>
std::string text_of(const char (&field)[n]) {
  return printable_utf8(std::string(field, strnlen(field, n)));
}

class BlockDut final : public Dut {
 public:
  BlockDut(std::string program, double timeout_s) : program_(std::move(program)), timeout_s_(timeout_s) {}
  ~BlockDut() override { stop(); }

  Result<DutInfo> open(const DutSession& session) override {
    stop();
    counters_ = {};
    where_ = printable_utf8(session.image.string());
    FORCEGATE_TRY(const link::Image image, link::inspect_image(session.image));
    if (image.port != "block" || image.board.empty())
      return fail(ErrorCode::usage, "the image is not built for the block port", where_,
                  "link rigs/firmware/ports/block.c, or choose the lane " +
                      (image.port.empty() ? std::string("that the image was built for") : image.port));
    FORCEGATE_CHECK_OK(qemu_.make_folder());
    FORCEGATE_TRY(request_, make_pipe("request"));
    FORCEGATE_TRY(answer_, make_pipe("answer"));
    FORCEGATE_CHECK_OK(qemu_.start(program_, image.board, session.image,
                                   {"-serial", "none", "-semihosting-config", "enable=on,target=native"}));
    return handshake(session);
  }

  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    // One block is always on its way while the one before it is collected.
    std::size_t sent = 0, done = 0;
    while (done < adc.size()) {
      while (sent < adc.size() && sent - done <= kBlockMax) {
        const std::size_t n = std::min(kBlockMax, adc.size() - sent);
        const BlockHead head{magic("FGBD"), first_index + static_cast<std::uint32_t>(sent),
                             static_cast<std::uint32_t>(n), 0};
        out_.resize(sizeof head + 2 * n);
        std::memcpy(out_.data(), &head, sizeof head);
        std::memcpy(out_.data() + sizeof head, adc.data() + sent, 2 * n);
        FORCEGATE_CHECK_OK(send(out_.data(), out_.size()));
        sent += n;
      }
      const std::size_t n = std::min(kBlockMax, adc.size() - done);
      FORCEGATE_CHECK_OK(collect(first_index + static_cast<std::uint32_t>(done), force_N.subspan(done, n),
                                 flags.subspan(done, n)));
      done += n;
    }
    counters_.samples += adc.size();
    return {};
  }

  Result<DutCounters> close() override {
    if (request_ && !qemu_.dead()) {
      const BlockHead end{magic("FGBD"), 0, 0, 0};
      if (send(&end, sizeof end)) qemu_.finish(1.0);
    }
    stop();
    return counters_;
  }

 private:
  Result<Descriptor> make_pipe(const char* name) {
    const std::string path = (qemu_.folder() / name).string();
    if (mkfifo(path.c_str(), 0600) != 0)
      return fail(ErrorCode::io, "cannot make a named pipe: " + system_text(errno), path);
    Descriptor fd(
        ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));  // both ends: no waiting for the image
    if (!fd) return fail(ErrorCode::io, "cannot open a named pipe: " + system_text(errno), path);
    fcntl(fd.get(), F_SETPIPE_SZ, 1 << 18);
    return fd;
  }

  Result<DutInfo> handshake(const DutSession& session) {
    const Calibration& c = session.calibration;
    RequestHeader request{
        magic("FGBQ"), 1U << 8, session.nonce, static_cast<std::uint32_t>(session.rate_Hz), {}};
    request.calibration = {static_cast<float>(c.gain_N_per_V),
                           static_cast<float>(c.offset_N),
                           static_cast<float>(c.v_range_V),
                           static_cast<float>(c.b_scale),
                           static_cast<float>(c.q_scale),
                           static_cast<std::uint32_t>(c.adc_bits),
                           {}};
    std::memcpy(request.calibration.id, c.id.data(), std::min(c.id.size(), sizeof request.calibration.id));
    FORCEGATE_CHECK_OK(send(&request, sizeof request));
    AnswerHeader answer{};
    FORCEGATE_CHECK_OK(receive(&answer, sizeof answer));
    if (answer.magic != magic("FGBA"))
      return fail(ErrorCode::firmware, "the image does not answer with the block protocol (wrong magic)",
                  where_);
    if (answer.version >> 8 != 1)
      return fail(ErrorCode::firmware, "unknown protocol major " + std::to_string(answer.version >> 8),
                  where_);
    if (answer.nonce != session.nonce)
      return fail(ErrorCode::firmware, "the image does not echo the nonce: stale output is never judged",
                  where_);
    if (answer.status != 0)
      return fail(ErrorCode::firmware,
                  "the image refuses the calibration '" + printable_utf8(c.id) + "' or the rate", where_);
    if (std::memcmp(&answer.calibration, &request.calibration, sizeof request.calibration) != 0)
      return fail(ErrorCode::firmware, "the image does not echo the calibration", where_);
    return DutInfo{static_cast<int>(answer.version >> 8),
                   static_cast<int>(answer.version & 255U),
                   text_of(answer.board),
                   text_of(answer.build_id),
                   text_of(answer.algorithm_id),
                   answer.nonce,
                   c.adc_bits,
                   static_cast<double>(answer.rate_Hz)};
  }

  Result<void> collect(std::uint32_t first_index, std::span<float> force_N, std::span<std::uint8_t> flags) {
    in_.resize(sizeof(BlockHead) + 5 * force_N.size());
    FORCEGATE_CHECK_OK(receive(in_.data(), in_.size()));
    BlockHead head;
    std::memcpy(&head, in_.data(), sizeof head);
    if (head.magic != magic("FGBR") || head.n != force_N.size())
      return fail(ErrorCode::firmware, "the image answers with a broken block", where_);
    if (head.first_index != first_index || head.status != 0) {
      ++counters_.indices_lost;
      return fail(
          ErrorCode::firmware,
          "the image is at another sample than " + std::to_string(first_index) + ": samples were lost",
          where_);
    }
    std::memcpy(force_N.data(), in_.data() + sizeof head, 4 * force_N.size());
    std::memcpy(flags.data(), in_.data() + sizeof head + 4 * force_N.size(), flags.size());
    return {};
  }

  Result<void> send(const void* data, std::size_t size) {
    const auto* at = static_cast<const std::uint8_t*>(data);
    return move(size, POLLOUT, request_.get(), [&](std::size_t left) {
      const ssize_t n = ::write(request_.get(), at, left);
      if (n > 0) at += n;
      return n;
    });
  }

  Result<void> receive(void* data, std::size_t size) {
    auto* at = static_cast<std::uint8_t*>(data);
    return move(size, POLLIN, answer_.get(), [&](std::size_t left) {
      const ssize_t n = ::read(answer_.get(), at, left);
      if (n > 0) at += n;
      return n;
    });
  }

  /// Moves `size` bytes; the image has timeout_s_ for each step and is looked after every 100 ms.
  template <class Step>
  Result<void> move(std::size_t size, short events, int fd, Step step) {
    using Clock = std::chrono::steady_clock;
    auto last = Clock::now();
    bool waited = false;
    while (size > 0) {
      if (!waited && events == POLLIN) {  // the answer is hardly ever there already
        pollfd p{fd, events, 0};
        poll(&p, 1, 100);
      }
      const ssize_t n = step(size);
      if (n > 0) {
        size -= static_cast<std::size_t>(n);
        if (waited) last = Clock::now();
        waited = false;
        continue;
      }
      if (errno == EINTR) continue;
      if (errno != EAGAIN) return fail(ErrorCode::io, "named pipe: " + system_text(errno), where_);
      if (qemu_.dead()) return Unexpected(qemu_.death(where_));
      if (std::chrono::duration<double>(Clock::now() - last).count() > timeout_s_)
        return fail(ErrorCode::firmware, "the image gives no answer for " + shortest(timeout_s_) + " s",
                    where_, "look for an endless loop or a wait for an interrupt that never comes");
      pollfd p{fd, events, 0};
      poll(&p, 1, 100);
      waited = true;
    }
    return {};
  }

  void stop() {
    qemu_.stop();
    request_.reset();
    answer_.reset();
  }

  std::string program_, where_;
  double timeout_s_;
  Qemu qemu_;
  Descriptor request_, answer_;
  std::vector<std::uint8_t> out_, in_;
  DutCounters counters_;
};

const Registration<LaneKind> kRegistered{{
    "block",
    "The Cortex-M image (block port) in qemu-system-arm with semihosting. Open loop; closed loop in short "
    "blocks.",
    [](const std::filesystem::path& path) {
      const auto image = link::inspect_image(path);
      return image && image->port == "block";
    },
    [](const std::map<std::string, std::string>& options) -> Result<std::unique_ptr<Dut>> {
      FORCEGATE_TRY(std::string program, Qemu::find(options));
      return std::make_unique<BlockDut>(std::move(program), Qemu::timeout_s(options, kTimeout_s));
    },
}};

}  // namespace
}  // namespace forcegate
