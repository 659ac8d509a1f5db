// The Cortex-M image in qemu-system-arm. The board passes the harness's frames on to it as they came, and feeds its
// converter's codes by INJECT; the free-running stream is made of the answers.

#include <algorithm>
#include <chrono>

#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "adapters/transport/unix_socket.h"
#include "hil/base/text.h"
#include "rigs/emulated/twins/native_image.h"

namespace forcegate::emulated {
namespace {

constexpr double kTimeout_s = 20.0;
constexpr std::uint16_t kOwnSequence = 0xF000;  // of INJECT frames; the harness's requests keep their own

class UartImage final : public BoardImage {
 public:
  explicit UartImage(PrivateFolder folder) : folder_(std::move(folder)) {}

  Result<void> start(const std::string& path, const std::string& machine) {
    const auto program = find_program("qemu-system-arm");
    if (!program)
      return fail(ErrorCode::config, "qemu-system-arm is not installed", path,
                  "sudo apt-get install qemu-system-arm");
    const std::filesystem::path socket = folder_.path() / "uart";
    FORCEGATE_TRY(UnixListener listener, UnixListener::listen_at(socket));
    FORCEGATE_CHECK_OK(
        child_.start({program->string(), "-machine", machine, "-kernel", path, "-nodefaults", "-display",
                      "none", "-monitor", "none", "-chardev",
                      "socket,id=uart,path=" + socket.string() + ",server=off", "-serial", "chardev:uart"},
                     folder_.path(), folder_.path() / "log"));
    FORCEGATE_TRY(line_, listener.accept_peer(kTimeout_s));
    if (!line_ || !receive(0x81, 0))
      return fail(ErrorCode::firmware,
                  "the image does not announce itself: " + last_line(folder_.path() / "log"), path);
    return {};
  }

  std::string fate() const override {
    const auto how = child_.ended();
    return how ? "ended: " + *how : silent_ ? "gives no answer for " + shortest(kTimeout_s) + " s" : std::string();
  }
  std::uint8_t version() const override { return version_; }

  std::optional<BoardFrame> answer(const BoardFrame& request) override {
    if (!line_->write(frame_bytes(request), kTimeout_s)) return std::nullopt;
    if (request.type == 0x07) return receive(0x87, -1);
    return receive(0, request.sequence);
  }

  std::optional<Bytes> convert(std::uint32_t first_index, std::span<const std::uint16_t> adc) override {
    BoardFrame inject;
    inject.type = 0x03;
    inject.sequence = kOwnSequence;
    put_u32(inject.payload, first_index);
    inject.payload.push_back(static_cast<std::uint8_t>(adc.size()));
    for (const std::uint16_t code : adc) put_u16(inject.payload, code);
    if (!line_->write(frame_bytes(inject), kTimeout_s)) return std::nullopt;
    auto reply = receive(0, kOwnSequence);
    if (!reply || reply->type != 0x82) return std::nullopt;
    version_ = reply->version;
    reply->payload.erase(reply->payload.begin(), reply->payload.begin() + 2);
    return std::move(reply->payload);
  }

 private:
  /// The next frame of that type (0: any) that answers `request` (negative: none in particular).
  std::optional<BoardFrame> receive(std::uint8_t type, int request) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(kTimeout_s);
    while (Clock::now() < end) {
      while (!pending_.empty()) {
        const auto zero = std::find(pending_.begin(), pending_.end(), std::uint8_t{0});
        if (zero == pending_.end()) break;
        const auto frame = frame_of({pending_.data(), static_cast<std::size_t>(zero - pending_.begin())});
        pending_.erase(pending_.begin(), zero + 1);
        if (!frame || (type != 0 && frame->type != type)) continue;
        if (request >= 0 &&
            (frame->payload.size() < 2 || static_cast<int>(u16_at(frame->payload, 0)) != request))
          continue;
        return frame;
      }
      std::uint8_t bytes[4096];
      const auto n = line_->read(bytes, 0.1);
      if (!n || (*n == 0 && child_.ended())) return std::nullopt;
      pending_.insert(pending_.end(), bytes, bytes + *n);
    }
    silent_ = true;
    return std::nullopt;
  }

  PrivateFolder folder_;
  std::unique_ptr<Transport> line_;
  mutable ChildProcess child_;
  Bytes pending_;
  std::uint8_t version_ = 0x10;
  bool silent_ = false;
};

}  // namespace

Result<std::unique_ptr<BoardImage>> load_uart_image(const std::string& path, const std::string& machine) {
  FORCEGATE_TRY(PrivateFolder folder, PrivateFolder::make());
  auto image = std::make_unique<UartImage>(std::move(folder));
  FORCEGATE_CHECK_OK(image->start(path, machine));
  return image;
}

}  // namespace forcegate::emulated
