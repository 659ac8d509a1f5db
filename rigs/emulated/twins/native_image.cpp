#include "rigs/emulated/twins/native_image.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "hil/base/text.h"
#include "hil/interface/unanswered.h"

namespace forcegate::emulated {
namespace {

constexpr int kSilence_ms = 20000;
constexpr std::uint32_t kOpen = 1, kProcess = 2, kAbi = 1;
constexpr std::int32_t kNotLoaded = -1, kNoPort = -2;  ///< first word of the child; else the version of its interface
constexpr std::int32_t kUnanswered = -1;               ///< status of a block of which the image left samples out

struct NativeInfo {
  std::uint32_t nonce;
  std::uint16_t protocol_major, protocol_minor;
  std::uint32_t rate_Hz;
  BoardCalibration calibration;
  char board[24], build_id[40], algorithm_id[32];
};
static_assert(sizeof(BoardCalibration) == 40 && sizeof(NativeInfo) == 148);

struct Order {
  std::uint32_t what, first_index, n;
};

bool read_all(int fd, void* to, std::size_t size) {
  auto* at = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t n = ::read(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool write_all(int fd, const void* from, std::size_t size) {
  return ::send(fd, from, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

// Life of the child: one order, one answer, until the socket closes.
[[noreturn]] void live(void* library, int fd) {
  const auto open = reinterpret_cast<std::int32_t (*)(std::uint32_t, const BoardCalibration*, NativeInfo*)>(
      dlsym(library, "forcegate_native_open"));
  const auto process =
      reinterpret_cast<std::int32_t (*)(std::uint32_t, std::uint32_t, const std::uint16_t*, float*,
                                        std::uint8_t*)>(dlsym(library, "forcegate_native_process"));
  Order order{};
  std::vector<std::uint16_t> adc;
  std::vector<char> out;
  while (read_all(fd, &order, sizeof order)) {
    if (order.what == kOpen) {
      BoardCalibration calibration;
      if (!read_all(fd, &calibration, sizeof calibration)) break;
      NativeInfo info{};
      const std::int32_t status = open(order.first_index, &calibration, &info);
      write_all(fd, &status, sizeof status);
      write_all(fd, &info, sizeof info);
      continue;
    }
    adc.resize(order.n);
    if (!read_all(fd, adc.data(), 2 * adc.size())) break;
    out.assign(4 + 5 * adc.size(), 0);
    std::vector<float> force(adc.size());
    const std::span<std::uint8_t> flags{reinterpret_cast<std::uint8_t*>(out.data() + 4 + 4 * adc.size()), adc.size()};
    mark_unanswered(force, flags);
    std::int32_t status = process(order.first_index, order.n, adc.data(), force.data(), flags.data());
    if (status == 0 && count_unanswered(force, flags).samples > 0) status = kUnanswered;
    std::memcpy(out.data(), &status, 4);
    std::memcpy(out.data() + 4, force.data(), 4 * force.size());
    write_all(fd, out.data(), out.size());
  }
  _exit(0);
}

class NativeImage final : public MonitorImage {
 public:
  NativeImage(Descriptor fd, pid_t child) : fd_(std::move(fd)), child_(child) {}
  ~NativeImage() override {
    fd_.reset();
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

 private:
  std::string fate() const override { return fate_; }

 public:
  /// What the child found in the file. Errors (firmware): no image, another interface, an image that ends as it is loaded.
  Result<void> loaded(const std::string& path) {
    std::int32_t first = kNotLoaded;
    if (!answered() || !read_all(fd_.get(), &first, sizeof first)) {
      ended("as it was loaded");
      return fail(ErrorCode::firmware, "the firmware " + fate_, path);
    }
    if (first == static_cast<std::int32_t>(kAbi)) return {};
    if (first == kNotLoaded) return fail(ErrorCode::firmware, "the image cannot be loaded", path);
    if (first == kNoPort)
      return fail(ErrorCode::usage, "the shared object does not export the functions of the native port", path, "build it with rigs/firmware/ports/native.h");
    return fail(ErrorCode::firmware, fmt::format("the image speaks version {} of the native interface, not {}", static_cast<std::uint32_t>(first), kAbi), path);
  }

 private:

  bool restart(std::uint32_t nonce, const BoardCalibration& calibration, BoardIdentity& identity) override {
    const Order order{kOpen, nonce, 0};
    std::int32_t status = 1;
    NativeInfo info{};
    if (!write_all(fd_.get(), &order, sizeof order) ||
        !write_all(fd_.get(), &calibration, sizeof calibration) || !answered() ||
        !read_all(fd_.get(), &status, sizeof status) || !read_all(fd_.get(), &info, sizeof info))
      return ended("as it was opened");
    identity.nonce = info.nonce;
    identity.version = static_cast<std::uint8_t>(std::min<unsigned>(info.protocol_major, 15) << 4 |
                                                 std::min<unsigned>(info.protocol_minor, 15));
    identity.calibration = info.calibration;
    std::copy(std::begin(info.board), std::end(info.board), identity.board.begin());
    std::copy(std::begin(info.build_id), std::end(info.build_id), identity.build_id.begin());
    std::copy(std::begin(info.algorithm_id), std::end(info.algorithm_id), identity.algorithm.begin());
    identity.rate_Hz = info.rate_Hz;
    return status == 0;
  }

  bool run(std::uint32_t first_index, std::span<const std::uint16_t> adc, float* force_N,
           std::uint8_t* flags) override {
    const Order order{kProcess, first_index, static_cast<std::uint32_t>(adc.size())};
    std::int32_t status = 1;
    const std::string at = fmt::format("after sample {}", first_index);
    if (!write_all(fd_.get(), &order, sizeof order) || !write_all(fd_.get(), adc.data(), 2 * adc.size()) ||
        !answered() || !read_all(fd_.get(), &status, sizeof status) ||
        !read_all(fd_.get(), force_N, 4 * adc.size()) || !read_all(fd_.get(), flags, adc.size()))
      return ended(at);
    if (status == kUnanswered) fate_ = "leaves samples without force or flags (eight at once are none) " + at;
    else if (status != 0) fate_ = fmt::format("answers status {} {}", status, at);
    return status == 0;
  }

  // The child knows why it does not answer any more: it is gone, or it still runs.
  bool ended(const std::string& at) {
    int status = 0;
    const pid_t gone = child_ > 0 ? waitpid(child_, &status, hangs_ ? WNOHANG : 0) : 0;
    if (gone == child_ && gone > 0) {
      child_ = -1;
      fate_ = WIFSIGNALED(status)
                  ? fmt::format("crashed with signal {} {}", signal_name(WTERMSIG(status)), at)
                  : fmt::format("ended with exit code {} {}", WEXITSTATUS(status), at);
    } else if (fate_.empty()) {
      fate_ = fmt::format("does not return {}", at);
    }
    return false;
  }

  static std::string signal_name(int signal) {
    const char* name = sigabbrev_np(signal);
    return name != nullptr ? name : std::to_string(signal);
  }

  bool answered() {
    pollfd p{fd_.get(), POLLIN, 0};
    hangs_ = ::poll(&p, 1, kSilence_ms) <= 0;
    return !hangs_;
  }

  Descriptor fd_;
  pid_t child_;
  bool hangs_ = false;
  std::string fate_;
};

}  // namespace

Result<std::unique_ptr<BoardImage>> load_native_image(const std::string& path) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(ErrorCode::io, "cannot make a pair of sockets: " + system_text(errno), path, "too many files are open: see ulimit -n");
  Descriptor ours(ends[0]), theirs(ends[1]);
  pid_t child = fork();
  if (child < 0) return fail(ErrorCode::io, "cannot start a process: " + system_text(errno), path, "too many processes run or memory is short: see ulimit -u and free");
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    close_inherited(theirs.get());  // a port that the image held open could not be unplugged
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    const auto abi = library != nullptr ? reinterpret_cast<std::uint32_t (*)()>(dlsym(library, "forcegate_native_abi")) : nullptr;
    const bool port = abi != nullptr && dlsym(library, "forcegate_native_open") != nullptr &&
                      dlsym(library, "forcegate_native_process") != nullptr;
    const auto first = library == nullptr ? kNotLoaded : !port ? kNoPort : static_cast<std::int32_t>(abi());
    write_all(theirs.get(), &first, sizeof first);
    if (first != static_cast<std::int32_t>(kAbi)) _exit(2);
    live(library, theirs.get());
  }
  theirs.reset();
  auto image = std::make_unique<NativeImage>(std::move(ours), child);
  FORCEGATE_CHECK_OK(image->loaded(path));
  return image;
}

}  // namespace forcegate::emulated
