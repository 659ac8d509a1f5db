// The bench on the table: serial ports by stable name, time from the monotonic clock.

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <filesystem>

#include "adapters/hid/report_line.h"
#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "adapters/transport/network.h"
#include "adapters/transport/serial.h"
#include "hil/base/text.h"
#include "hil/interface/bench_world.h"

namespace forcegate {
namespace {

class RealWorld final : public BenchWorld {
 public:
  RealWorld(std::map<std::string, std::string> ports, std::vector<std::string> flash, std::filesystem::path folder)
      : ports_(std::move(ports)), flash_(std::move(flash)), folder_(std::move(folder)) {}

  Result<std::string> serial_path(const std::string& port) override {
    if (port.starts_with("/")) return port;
    const auto at = ports_.find(port);
    if (at == ports_.end())
      return fail(
          ErrorCode::config, "the bench file has no port '" + printable_utf8(port) + "'", "[ports]",
          "add " + port + " = \"/dev/serial/by-id/...\"; forcegate bench scan lists what is connected");
    return at->second;
  }

  Result<std::unique_ptr<Transport>> open_line(const std::string& port, const LineSettings& s) override {
    FORCEGATE_TRY(const std::string path, serial_path(port));
    const Parity parity = s.parity == LineParity::even  ? Parity::even
                          : s.parity == LineParity::odd ? Parity::odd
                                                        : Parity::none;
    return open_serial(path, {s.baud, parity});
  }

  Result<std::unique_ptr<Transport>> open_hid(unsigned short vendor, unsigned short product,
                                              const std::string& serial) override {
    return hid::open_hidraw(vendor, product, serial);
  }

  Result<std::unique_ptr<Transport>> open_datagrams(const std::string& device, const std::string& host,
                                                    int port) override {
    if (port > 0) return connect_udp(host, port);
    return fail(ErrorCode::config, "[" + device + "] needs a udp_port", {}, "49152 is the one of Net F/T");
  }

  Result<int> tcp_port(const std::string& device, int declared) override {
    if (declared > 0) return declared;
    return fail(ErrorCode::config, "[" + device + "] needs a tcp_port", {}, "502 is the usual one");
  }

  double now_s() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

  Result<void> advance_to(double t_s) override {
    const double whole_s = t_s + std::chrono::duration<double>(start_.time_since_epoch()).count();
    timespec until{};
    until.tv_sec = static_cast<std::time_t>(whole_s);
    until.tv_nsec = static_cast<long>((whole_s - static_cast<double>(until.tv_sec)) * 1e9);
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
    return {};
  }

  bool is_virtual() const override { return false; }
  Result<void> mount(const RigRecordRequest&) override { return {}; }

  bool flashes() const override { return !flash_.empty(); }
  Result<void> flash(const std::string& image) override {
    if (flash_.empty()) return {};
    std::vector<std::string> argv = flash_;
    static const std::string kImage = "{image}";
    const std::string whole = std::filesystem::absolute(image).string();  // the program runs beside the bench file
    for (std::string& word : argv)
      for (std::size_t at = 0; (at = word.find(kImage, at)) != std::string::npos; at += whole.size()) word.replace(at, kImage.size(), whole);
    const auto program = find_program(argv.front(), folder_);
    if (!program)
      return fail(ErrorCode::config, "the program that flashes the board is not installed: " + argv.front(),
                  "[board] flash", "install it, or name its file: with '/' it is relative to the bench file, " + folder_.string());
    argv.front() = program->string();
    FORCEGATE_TRY(const PrivateFolder folder, PrivateFolder::make());
    ChildProcess child;
    FORCEGATE_CHECK_OK(child.start(argv, folder_, folder.path() / "log"));
    child.finish(kFlash_s);
    const auto end = child.ended();
    if (end == "exit code 0") return {};
    for (std::string& word : argv) word = shell_quoted(word);
    return fail(
        ErrorCode::device,
        "flashing the board failed: " + end.value_or("no end") + ": " + last_line(folder.path() / "log"),
        "board: " + program->string(), "run it by hand in " + folder_.string() + ": " + join(argv, " "));
  }

 private:
  static constexpr double kFlash_s = 120.0;
  std::map<std::string, std::string> ports_;
  std::vector<std::string> flash_;
  std::filesystem::path folder_;  ///< of the bench file
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Result<std::unique_ptr<BenchWorld>> make(const ConfigNode& bench, const std::map<std::string, std::string>&) {
  std::map<std::string, std::string> ports;
  if (const ConfigNode* table = bench.find("ports"))
    for (std::size_t i = 0; i < table->names.size(); ++i) ports[table->names[i]] = table->items[i].text;
  std::vector<std::string> flash;
  if (const ConfigNode* board = bench.find("board"))
    if (const ConfigNode* list = board->find("flash"))
      for (const ConfigNode& word : list->items) flash.push_back(word.text);
  return std::make_unique<RealWorld>(std::move(ports), std::move(flash), std::filesystem::absolute(bench.file).parent_path());
}

const Registration<BenchWorldKind> kRegistered{
    {"real", "Instruments on serial ports and the network, time by the clock on the wall", make}};

}  // namespace
}  // namespace forcegate
