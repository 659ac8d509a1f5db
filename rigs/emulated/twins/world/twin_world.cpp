// A world of twins: starts them in a process of their own (or attaches to a bench that `forcegate bench serve` runs),
// moves their time and counts bytes, so that the same run gives the same bytes however busy the machine is.

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <deque>
#include <fstream>
#include <optional>
#include <thread>

#include "adapters/transport/network.h"
#include "adapters/transport/private_folder.h"
#include "adapters/transport/serial.h"
#include "hil/base/text.h"
#include "hil/interface/bench_world.h"
#include "rigs/emulated/twins/client.h"
#include "rigs/emulated/twins/host.h"

namespace forcegate::emulated {
namespace {

constexpr double kByteWait_s = 20.0;
constexpr double kFarewell_s = 1.0;

std::atomic<bool> told_to_end{false};  // in the process of the twins

class TwinWorld;

/// Line whose bytes are counted. In virtual time everything that the twin has sent is fetched as time goes on.
class CountedLine final : public Transport {
 public:
  CountedLine(TwinWorld& world, std::string device, std::unique_ptr<Transport> inner)
      : world_(world), device_(std::move(device)), inner_(std::move(inner)) {}
  ~CountedLine() override;

  Result<void> write(std::span<const std::uint8_t> bytes, double timeout_s) override {
    FORCEGATE_CHECK_OK(inner_->write(bytes, timeout_s));
    sent_ += bytes.size();
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double timeout_s) override {
    if (fetched_.empty()) {
      auto got = inner_->read(into, timeout_s);
      if (got) received_ += *got;
      return got;
    }
    std::vector<std::uint8_t>& front = fetched_.front();
    const std::size_t n = std::min(into.size(), front.size());
    std::copy_n(front.begin(), n, into.begin());
    front.erase(front.begin(), front.begin() + static_cast<std::ptrdiff_t>(n));
    if (front.empty()) fetched_.pop_front();
    return n;
  }
  std::string name() const override { return inner_->name(); }

  Result<void> fetch_until(std::uint64_t count) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kByteWait_s);
    while (received_ < count) {
      std::uint8_t bytes[4096];
      auto n = inner_->read(bytes, 0.05);
      if (!n) return {};  // the adapter will find out by itself
      received_ += *n;
      if (*n > 0) fetched_.emplace_back(bytes, bytes + *n);
      if (*n == 0 && std::chrono::steady_clock::now() > end)
        return fail(ErrorCode::internal,
                    fmt::format("bytes of the twin were lost: {} of {}", received_, count), name());
    }
    return {};
  }
  const std::string& device() const { return device_; }
  std::uint64_t sent() const { return sent_; }

 private:
  TwinWorld& world_;
  std::string device_;
  std::unique_ptr<Transport> inner_;
  std::deque<std::vector<std::uint8_t>> fetched_;  ///< as they came: a datagram stays one
  std::uint64_t sent_ = 0, received_ = 0;
};

class TwinWorld final : public BenchWorld {
 public:
  TwinWorld(TwinOptions options, bool paced) : options_(std::move(options)), paced_(paced) {}
  ~TwinWorld() override {
    client_.reset();
    if (child_ <= 0) return;
    ::kill(child_, SIGTERM);  // so that they leave nothing behind
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kFarewell_s);
    while (std::chrono::steady_clock::now() < end) {
      const pid_t gone = waitpid(child_, nullptr, WNOHANG);
      if (gone == child_ || (gone < 0 && errno != EINTR)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ::kill(child_, SIGKILL);
    while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  Result<void> attach(const std::filesystem::path& folder, double timeout_s = 1.0) {
    folder_ = folder;
    FORCEGATE_TRY(TwinClient client, TwinClient::connect(folder_, timeout_s));
    client_.emplace(std::move(client));
    if (!paced_) FORCEGATE_CHECK_OK(client_->say("advance 0"));  // from here on time is ours
    started_ = std::chrono::steady_clock::now();
    return {};
  }

  Result<void> start() {
    FORCEGATE_TRY(PrivateFolder made, PrivateFolder::make());
    own_folder_.emplace(std::move(made));
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return fail(ErrorCode::io, "no pipe: " + system_text(errno), "[twins]", "too many files are open: see ulimit -n");
    Descriptor in(ends[0]), out(ends[1]);
    const pid_t parent = getpid();
    child_ = fork();
    if (child_ < 0) return fail(ErrorCode::io, "cannot start the twins: " + system_text(errno), "[twins]", "too many processes run or memory is short: see ulimit -u and free");
    if (child_ == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != parent) _exit(0);
      setpgid(0, 0);
      ::signal(SIGINT, SIG_DFL);
      ::signal(SIGTERM, [](int) { told_to_end.store(true); });
      close_inherited(out.get());
      serve(out.get());
    }
    out.reset();
    std::string told;
    char bytes[1024];
    for (ssize_t n; (n = ::read(in.get(), bytes, sizeof bytes)) != 0;) {
      if (n < 0 && errno != EINTR) break;
      if (n > 0) told.append(bytes, static_cast<std::size_t>(n));
    }
    if (told != "ready") {
      const std::size_t end = std::min(told.find('\n'), told.size());
      return fail(ErrorCode::config, told.empty() ? "the twins did not start" : printable_utf8(told.substr(0, end)), "[twins]",
                  printable_utf8(std::string_view(told).substr(std::min(end + 1, told.size()))));
    }
    return attach(own_folder_->path(), 10.0);
  }

  Result<std::string> serial_path(const std::string& port) override {
    const std::filesystem::path path = folder_ / port;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
      return fail(ErrorCode::device, "the twins have no port '" + printable_utf8(port) + "' (unplugged?)",
                  path.string());
    return path.string();
  }

  Result<std::unique_ptr<Transport>> open_line(const std::string& port, const LineSettings& s) override {
    FORCEGATE_TRY(const std::string path, serial_path(port));
    const Parity parity = s.parity == LineParity::even  ? Parity::even
                          : s.parity == LineParity::odd ? Parity::odd
                                                        : Parity::none;
    FORCEGATE_TRY(auto inner, open_serial(path, {s.baud, parity}));
    const std::string device = port == options_.reference_port ? "reference"
                               : port == options_.board_port   ? "board"
                                                               : "motor";
    return counted(device, std::move(inner));
  }
  Result<std::unique_ptr<Transport>> open_datagrams(const std::string& device, const std::string& host,
                                                    int declared) override {
    FORCEGATE_TRY(const int port, published(device + ".udp", declared));
    FORCEGATE_TRY(auto inner, connect_udp(host, port));
    return counted(device, std::move(inner));
  }
  Result<std::unique_ptr<Transport>> open_hid(unsigned short, unsigned short, const std::string&) override {
    return open_line(options_.board_port, {});  // the twin's terminal carries whole reports
  }
  void forget(const CountedLine* line) { std::erase(lines_, line); }

  Result<int> tcp_port(const std::string& device, int declared) override {
    return published(device + ".port", declared);
  }

  double now_s() const override {
    if (!paced_) return now_s_;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  }
  bool is_virtual() const override { return !paced_; }

  Result<void> advance_to(double t_s) override {
    if (paced_) {
      std::this_thread::sleep_until(started_ +
                                    std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                        std::chrono::duration<double>(t_s)));
      return {};
    }
    const auto samples = static_cast<std::int64_t>(std::llround((t_s - now_s_) * options_.plant.rate_Hz));
    if (samples <= 0) return {};
    std::string order = fmt::format("advance {}", samples);
    for (const CountedLine* line : lines_) order += fmt::format(" {}={}", line->device(), line->sent());
    FORCEGATE_TRY(const std::string reply, client_->say(order));
    now_s_ += static_cast<double>(samples) / options_.plant.rate_Hz;
    for (const std::string& word : split(reply, ' '))
      for (CountedLine* line : lines_) {
        if (!word.starts_with(line->device() + "=")) continue;
        std::int64_t count = -1;
        const char* begin = word.data() + line->device().size() + 1;
        std::from_chars(begin, word.data() + word.size(), count);
        if (count >= 0) FORCEGATE_CHECK_OK(line->fetch_until(static_cast<std::uint64_t>(count)));
      }
    return {};
  }

  Result<void> mount(const RigRecordRequest& q) override {
    std::string order = fmt::format(
        "mount specimen={} seed={} session={} record={} rest_s={:.17g} low_N={:.17g} high_N={:.17g}",
        q.specimen, q.seed, q.session, q.record, q.rest_before_s, q.force_low_N, q.force_high_N);
    for (const auto& [name, magnitude] : q.faults) order += fmt::format(" fault:{}={:.17g}", name, magnitude);
    FORCEGATE_CHECK_OK(client_->say(order));
    return {};
  }

  std::string guard_option() const override { return folder_.string(); }

  bool flashes() const override { return true; }
  Result<void> flash(const std::string& image) override {
    auto done = client_->say("flash " + std::filesystem::absolute(image).string());
    if (!done)
      return Unexpected(Error{done.error().code, done.error().text, "board: " + image, done.error().hint});
    return {};
  }

  FirmwareFate firmware_fate() override {
    const auto told = client_->say("image");
    if (!told) return {};
    return {true, *told == "runs" ? std::string() : *told};
  }

 private:
  Result<std::unique_ptr<Transport>> counted(const std::string& device, std::unique_ptr<Transport> inner) {
    FORCEGATE_CHECK_OK(client_->say("attach " + device));
    auto line = std::make_unique<CountedLine>(*this, device, std::move(inner));
    lines_.push_back(line.get());
    return line;
  }
  Result<int> published(const std::string& file, int declared) const {
    if (declared > 0) return declared;
    int port = 0;
    std::ifstream(folder_ / file) >> port;
    if (port > 0) return port;
    return fail(ErrorCode::device, "the twins publish no such port", (folder_ / file).string());
  }
  [[noreturn]] void serve(int out) {
    auto host = TwinHost::make(options_, own_folder_->path());
    const std::string text = host ? "ready" : host.error().text + "\n" + host.error().hint;
    if (::write(out, text.data(), text.size()) < 0) _exit(1);
    ::close(out);
    if (!host) _exit(1);
    (*host)->serve(told_to_end, true);
    host->reset();
    _exit(0);
  }

  TwinOptions options_;
  bool paced_;
  std::optional<PrivateFolder> own_folder_;
  std::filesystem::path folder_;
  std::optional<TwinClient> client_;
  pid_t child_ = -1;
  std::vector<CountedLine*> lines_;
  double now_s_ = 0.0;
  std::chrono::steady_clock::time_point started_;
};

CountedLine::~CountedLine() { world_.forget(this); }

Result<std::unique_ptr<BenchWorld>> make(const ConfigNode& bench,
                                         const std::map<std::string, std::string>& given) {
  FORCEGATE_TRY(TwinOptions options, read_twin_options(bench));
  std::string clock = "virtual", folder;
  const ConfigNode* twins = bench.find("twins");
  if (const ConfigNode* n = twins->find("clock")) clock = n->text;
  if (const auto at = given.find("clock"); at != given.end()) clock = at->second;
  if (clock != "virtual" && clock != "paced")
    return fail(ErrorCode::config, "the clock of twins cannot be '" + printable_utf8(clock) + "'", {},
                "choose virtual or paced");
  auto world = std::make_unique<TwinWorld>(std::move(options), clock == "paced");
  if (const auto at = given.find("attach"); at != given.end()) {
    FORCEGATE_CHECK_OK(world->attach(at->second));
  } else {
    FORCEGATE_CHECK_OK(world->start());
  }
  return world;
}

const Registration<BenchWorldKind> kRegistered{
    {"twins", "Wire-level twins of the instruments around the emulated plant, in virtual or paced time",
     make}};

}  // namespace
}  // namespace forcegate::emulated
