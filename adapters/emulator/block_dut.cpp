#include "adapters/emulator/block_dut.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cstring>
#include <optional>

#include "adapters/emulator/answer_wait.h"
#include "adapters/emulator/qemu.h"
#include "adapters/transport/descriptor.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

static_assert(std::endian::native == std::endian::little, "blocks are written as the host has them");

constexpr std::size_t kBlockMax = 4096;
// Virtual nanoseconds an instruction takes are 2^kShift: a core of 15.6 million instructions a second, whose
// cost in ticks of the 25 MHz clock resolves every single instruction.
constexpr int kShift = 6;
constexpr double kInstructionsPerTick = 40.0 / (1 << kShift);

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
  BlockDut(std::string program, double timeout_s, BlockMode mode)
      : program_(std::move(program)), timeout_s_(timeout_s), ticking_(mode == BlockMode::tick) {}
  ~BlockDut() override { stop(); }

  Result<DutInfo> open(const DutSession& session) override {
    stop();
    counters_ = {};
    resources_ = {};
    cost_sum_ = cost_worst_ = 0;
    rate_Hz_ = session.rate_Hz;
    where_ = printable_utf8(session.image.string());
    FORCEGATE_TRY(const link::Image image, link::inspect_image(session.image));
    FORCEGATE_CHECK_OK(link::check_whole(image, where_));
    if (image.port != "block" || image.board.empty())
      return fail(ErrorCode::usage, "the image is not built for the block port", where_,
                  "link rigs/firmware/ports/block.c, or choose the lane " +
                      (image.port.empty() ? std::string("that the image was built for") : image.port));
    if (ticking_ && !image.ticks)
      return fail(ErrorCode::usage, "the image cannot be paced by its own clock", where_,
                  "link rigs/firmware/ports/tick.c and announce forcegate-tick:1, or choose the lane block");
    FORCEGATE_CHECK_OK(qemu_.make_folder());
    FORCEGATE_TRY(request_, make_pipe("request"));
    FORCEGATE_TRY(answer_, make_pipe("answer"));
    std::vector<std::string> extra{"-serial", "none", "-semihosting-config", "enable=on,target=native"};
    if (ticking_)
      extra.insert(extra.end(), {"-icount", "shift=" + std::to_string(kShift) + ",align=off,sleep=off"});
    FORCEGATE_CHECK_OK(qemu_.start(program_, image.board, session.image, extra));
    FORCEGATE_TRY(DutInfo info, handshake(session));
    FORCEGATE_CHECK_OK(link::check_build_id(image, info.build_id, where_));
    resources_.ram_bytes = image.ram_bytes;
    resources_.flash_bytes = image.flash_bytes;
    return info;
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
    Result<void> costs;
    if (request_ && !qemu_.dead()) {
      const BlockHead end{magic("FGBD"), 0, 0, 0};
      const bool told = static_cast<bool>(send(&end, sizeof end));
      if (told && ticking_) costs = take_costs();
      if (told && costs) qemu_.finish(1.0);
    }
    stop();  // whatever the image has answered: nobody may find the emulator running
    FORCEGATE_CHECK_OK(costs);
    return counters_;
  }

  DutResources resources() const override { return resources_; }

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
    RequestHeader request{magic(ticking_ ? "FGBT" : "FGBQ"),
                          1U << 8,
                          session.nonce,
                          static_cast<std::uint32_t>(session.rate_Hz),
                          {}};
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
    FORCEGATE_CHECK_OK(check_echo({static_cast<int>(answer.version >> 8), answer.nonce,
                                   answer.status != 0 || std::memcmp(&answer.calibration, &request.calibration, sizeof request.calibration) == 0,
                                   static_cast<double>(answer.rate_Hz)},
                                  session, "the image", where_));
    if (answer.status != 0)
      return fail(ErrorCode::firmware, "the image refuses the calibration '" + printable_utf8(c.id) + "'", where_);
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
    in_.resize(sizeof(BlockHead) + (ticking_ ? 9 : 5) * force_N.size());
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
    if (ticking_) add_costs(in_.data() + sizeof head + 5 * force_N.size(), force_N.size(), first_index);
    return {};
  }

  void add_costs(const std::uint8_t* costs, std::size_t n, std::uint32_t first_index) {
    for (std::size_t i = 0; i < n; ++i) {
      std::uint32_t cost = 0;
      std::memcpy(&cost, costs + 4 * i, sizeof cost);
      cost_sum_ += cost;
      if (cost > cost_worst_) {
        cost_worst_ = cost;
        resources_.worst_at_s = (static_cast<double>(first_index) + static_cast<double>(i)) / rate_Hz_;
      }
    }
  }

  // The last block tells what only the image can know.
  Result<void> take_costs() {
    BlockHead end{};
    FORCEGATE_CHECK_OK(receive(&end, sizeof end));
    if (end.magic != magic("FGBE"))
      return fail(ErrorCode::firmware, "the image does not end with its account of time and stack", where_);
    resources_.late = end.first_index;
    resources_.stack_bytes = end.n;
    if (counters_.samples == 0) return {};
    resources_.instructions_worst = cost_worst_ * kInstructionsPerTick;
    resources_.instructions_mean =
        static_cast<double>(cost_sum_) * kInstructionsPerTick / static_cast<double>(counters_.samples);
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

  /// Moves `size` bytes; the image has timeout_s_ for each step (AnswerWait) and is looked after every 100 ms.
  template <class Step>
  Result<void> move(std::size_t size, short events, int fd, Step step) {
    std::optional<AnswerWait> wait;  // the answer is mostly there at once
    bool waited = false;
    while (size > 0) {
      if (!waited && events == POLLIN) {  // the answer is hardly ever there already
        pollfd p{fd, events, 0};
        poll(&p, 1, 100);
      }
      const ssize_t n = step(size);
      if (n > 0) {
        size -= static_cast<std::size_t>(n);
        if (waited) wait.reset();
        waited = false;
        continue;
      }
      if (errno == EINTR) continue;
      if (errno != EAGAIN) return fail(ErrorCode::io, "named pipe: " + system_text(errno), where_);
      if (qemu_.dead()) return Unexpected(qemu_.death(where_));
      if (!wait) wait.emplace(qemu_.id(), timeout_s_);
      FORCEGATE_CHECK_OK(wait->look("", where_, "look for an endless loop or a wait for an interrupt that never comes"));
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
  double timeout_s_, rate_Hz_ = 1000.0;
  bool ticking_;
  std::uint64_t cost_sum_ = 0;
  std::uint32_t cost_worst_ = 0;
  DutResources resources_;
  Qemu qemu_;
  Descriptor request_, answer_;
  std::vector<std::uint8_t> out_, in_;
  DutCounters counters_;
};

}  // namespace

std::unique_ptr<Dut> make_block_dut(std::string program, double timeout_s, BlockMode mode) {
  return std::make_unique<BlockDut>(std::move(program), timeout_s, mode);
}

}  // namespace forcegate
